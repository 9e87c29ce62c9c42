#include "viewer/devices/x11_connection.h"

#include <X11/Xlib.h>
#include <X11/extensions/XInput2.h>

#include <mutex>
#include <set>

namespace tangi {

namespace {

// Of all connections; an error handler has no other way to know them.
struct Open {
    std::mutex mutex;
    std::set<Display*> displays;
    XErrorHandler before = nullptr;  // that was there before the first
};

Open& open_ones() {
    static Open open;
    return open;
}

int on_error(Display* display, XErrorEvent* error) {
    Open& open = open_ones();
    XErrorHandler before = nullptr;
    {
        const std::lock_guard lock(open.mutex);
        if (open.displays.contains(display)) return 0;
        before = open.before;
    }
    return before ? before(display, error) : 0;
}

Display* opened() {
    Display* display = XOpenDisplay(nullptr);
    if (!display) return nullptr;
    Open& open = open_ones();
    const std::lock_guard lock(open.mutex);
    if (open.displays.empty()) open.before = XSetErrorHandler(on_error);
    open.displays.insert(display);
    return display;
}

// What it was asked for is answered before it is forgotten: errors may still be among that.
void close(Display* display) {
    XSync(display, True);
    XCloseDisplay(display);
    Open& open = open_ones();
    const std::lock_guard lock(open.mutex);
    open.displays.erase(display);
    if (open.displays.empty()) XSetErrorHandler(open.before);
}

}  // namespace

X11Connection::X11Connection(int minor_version) : display_(opened()) {
    if (!display_) return;
    // From 2.1 on, what a device does is heard while another program has grabbed it.
    int event = 0, error = 0, major = 2, minor = 2;
    if (XQueryExtension(display_, "XInputExtension", &opcode_, &event, &error) &&
        XIQueryVersion(display_, &major, &minor) == Success && (major > 2 || minor >= minor_version))
        return;
    close(display_);
    display_ = nullptr;
}

X11Connection::~X11Connection() {
    if (display_) close(display_);
}

void X11Connection::select(unsigned long window, int device, const std::vector<int>& events) const {
    std::vector<unsigned char> bits(XIMaskLen(XI_LASTEVENT), 0);
    for (const int one : events) XISetMask(bits.data(), one);
    XIEventMask mask{device, static_cast<int>(bits.size()), bits.data()};
    XISelectEvents(display_, window == 0 ? DefaultRootWindow(display_) : window, &mask, 1);
}

void X11Connection::hear(const std::function<void(int type, const void* data)>& event) {
    while (display_ && XPending(display_) > 0) {
        XEvent next;
        XNextEvent(display_, &next);
        XGenericEventCookie& cookie = next.xcookie;
        if (cookie.type != GenericEvent || cookie.extension != opcode_) continue;
        if (!XGetEventData(display_, &cookie)) continue;
        event(cookie.evtype, cookie.data);
        XFreeEventData(display_, &cookie);
    }
}

}  // namespace tangi
