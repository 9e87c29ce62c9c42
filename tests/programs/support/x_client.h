// x_client.h: what a desktop does to a window beside pointer and keys: its properties, and files dropped on
// windows.
#pragma once

#include <X11/Xatom.h>
#include <X11/Xlib.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

namespace tangi {

class XClient {
public:
    explicit XClient(const std::string& display) : display_(XOpenDisplay(display.c_str())) {
        if (display_) window_ = XCreateSimpleWindow(display_, root(), 0, 0, 1, 1, 0, 0, 0);
    }
    ~XClient() {
        if (display_) XCloseDisplay(display_);
    }
    XClient(const XClient&) = delete;
    XClient& operator=(const XClient&) = delete;

    void set_profile(const std::string& icc) const { set_on_root("_ICC_PROFILE", XA_CARDINAL, icc); }
    // As a desktop tells its scale: 192 for screens of twice the usual density.
    void set_dpi(int dpi) const {
        set_on_root("RESOURCE_MANAGER", XA_STRING, "Xft.dpi:\t" + std::to_string(dpi) + "\n");
    }

    // Drags this text/uri-list over the first window that takes such, and lets go (XDND, version 5). False
    // where none takes it within ten seconds.
    bool drop(const std::string& uris, int x, int y) {
        const std::optional<::Window> target = aware_window();
        if (!target) return false;
        const auto l = [](Atom atom) { return static_cast<long>(atom); };
        XSetSelectionOwner(display_, atom("XdndSelection"), window_, CurrentTime);
        const long self = static_cast<long>(window_);
        send(*target, "XdndEnter", {self, 5L << 24, l(atom("text/uri-list")), 0, 0});
        send(*target, "XdndPosition",
             {self, 0, (static_cast<long>(x) << 16) | y, CurrentTime, l(atom("XdndActionCopy"))});
        if (!hear("XdndStatus", uris)) return false;
        send(*target, "XdndDrop", {self, 0, CurrentTime, 0, 0});
        return hear("XdndFinished", uris);
    }

private:
    // X's, not the tests of that name.
    ::Window root() const { return DefaultRootWindow(display_); }
    Atom atom(const char* name) const { return XInternAtom(display_, name, False); }

    void set_on_root(const char* name, Atom type, const std::string& bytes) const {
        XChangeProperty(display_, root(), atom(name), type, 8, PropModeReplace,
                        reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<int>(bytes.size()));
        XSync(display_, False);
    }

    std::optional<::Window> aware_window() const {
        ::Window top = 0, parent = 0, *children = nullptr;
        unsigned count = 0;
        std::optional<::Window> found;
        XQueryTree(display_, root(), &top, &parent, &children, &count);
        for (unsigned i = 0; i < count && !found; ++i) {
            int properties = 0;
            Atom* names = XListProperties(display_, children[i], &properties);
            if (names && std::find(names, names + properties, atom("XdndAware")) != names + properties)
                found = children[i];
            if (names) XFree(names);
        }
        if (children) XFree(children);
        return found;
    }

    void send(::Window to, const char* type, std::initializer_list<long> data) const {
        XEvent event{};
        event.xclient.type = ClientMessage;
        event.xclient.window = to;
        event.xclient.message_type = atom(type);
        event.xclient.format = 32;
        std::copy(data.begin(), data.end(), event.xclient.data.l);
        XSendEvent(display_, to, False, NoEventMask, &event);
        XFlush(display_);
    }

    // Gives what is dragged to whoever asks, until a message of this type comes.
    bool hear(const char* type, const std::string& uris) const {
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
        while (std::chrono::steady_clock::now() < end) {
            if (XPending(display_) == 0) {
                std::this_thread::sleep_for(std::chrono::milliseconds(10));
                continue;
            }
            XEvent event;
            XNextEvent(display_, &event);
            if (event.type == ClientMessage && event.xclient.message_type == atom(type)) return true;
            if (event.type != SelectionRequest) continue;
            const XSelectionRequestEvent& ask = event.xselectionrequest;
            XChangeProperty(display_, ask.requestor, ask.property, ask.target, 8, PropModeReplace,
                            reinterpret_cast<const unsigned char*>(uris.data()),
                            static_cast<int>(uris.size()));
            XEvent answer{};
            answer.xselection.type = SelectionNotify;
            answer.xselection.requestor = ask.requestor;
            answer.xselection.selection = ask.selection;
            answer.xselection.target = ask.target;
            answer.xselection.property = ask.property;
            answer.xselection.time = ask.time;
            XSendEvent(display_, ask.requestor, False, NoEventMask, &answer);
            XFlush(display_);
        }
        return false;
    }

    Display* display_;
    ::Window window_ = 0;
};

}  // namespace tangi
