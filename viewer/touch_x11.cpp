// touch_x11.cpp: fingers as XInput 2.2 tells of them, on a connection of its own.
#include <X11/Xlib.h>
#include <X11/extensions/XInput2.h>
#include <dlfcn.h>

#include <set>

#include "viewer/touch.h"

namespace tangi {

namespace {

// What has gone since, or what another program listens to already, is no error on this connection
// (pen_x11.cpp).
Display* touch_display = nullptr;
XErrorHandler other_errors = nullptr;

int on_error(Display* display, XErrorEvent* error) {
    if (display == touch_display) return 0;
    return other_errors ? other_errors(display, error) : 0;
}

// The window's number; 0 where GLFW was built for Wayland, and has no such function.
Window number_of(GLFWwindow* window) {
    using Ask = Window (*)(GLFWwindow*);
    const auto ask = reinterpret_cast<Ask>(::dlsym(RTLD_DEFAULT, "glfwGetX11Window"));
    return ask && window ? ask(window) : 0;
}

}  // namespace

struct TouchScreens::Impl {
    Display* display = nullptr;
    int opcode = 0;
    std::set<int> screens;  // devices; touch pads are none

    explicit Impl(GLFWwindow* glfw_window) {
        const Window window = number_of(glfw_window);
        if (window == 0) return;
        display = XOpenDisplay(nullptr);
        if (!display) return;
        touch_display = display;
        other_errors = XSetErrorHandler(on_error);
        int event = 0, error = 0, major = 2, minor = 2;
        if (!XQueryExtension(display, "XInputExtension", &opcode, &event, &error) ||
            XIQueryVersion(display, &major, &minor) != Success || (major == 2 && minor < 2)) {
            close();
            return;
        }
        select(DefaultRootWindow(display), XIAllDevices, {XI_HierarchyChanged});
        select(window, XIAllMasterDevices, {XI_TouchBegin, XI_TouchUpdate, XI_TouchEnd});
        find();
    }
    ~Impl() { close(); }

    void close() {
        if (!display) return;
        XSync(display, True);
        XSetErrorHandler(other_errors);
        XCloseDisplay(display);
        touch_display = display = nullptr;
    }

    void select(Window window, int device, const std::vector<int>& events) const {
        std::vector<unsigned char> bits(XIMaskLen(XI_LASTEVENT), 0);
        for (const int one : events) XISetMask(bits.data(), one);
        XIEventMask mask{device, static_cast<int>(bits.size()), bits.data()};
        XISelectEvents(display, window, &mask, 1);
    }

    void find() {
        screens.clear();
        int count = 0;
        XIDeviceInfo* devices = XIQueryDevice(display, XIAllDevices, &count);
        for (int i = 0; devices && i < count; ++i)
            for (int c = 0; c < devices[i].num_classes; ++c) {
                if (devices[i].classes[c]->type != XITouchClass) continue;
                const auto& touch = *reinterpret_cast<const XITouchClassInfo*>(devices[i].classes[c]);
                if (touch.mode == XIDirectTouch && devices[i].use == XISlavePointer)
                    screens.insert(devices[i].deviceid);
            }
        if (devices) XIFreeDeviceInfo(devices);
        XFlush(display);
    }

    std::vector<TouchEvent> take(double now_s) {
        std::vector<TouchEvent> events;
        while (display && XPending(display) > 0) {
            XEvent event;
            XNextEvent(display, &event);
            XGenericEventCookie& cookie = event.xcookie;
            if (cookie.type != GenericEvent || cookie.extension != opcode) continue;
            if (!XGetEventData(display, &cookie)) continue;
            if (cookie.evtype == XI_HierarchyChanged) {
                find();
            } else {
                const auto& touch = *static_cast<const XIDeviceEvent*>(cookie.data);
                const auto kind = cookie.evtype == XI_TouchBegin    ? TouchEvent::Kind::begin
                                  : cookie.evtype == XI_TouchUpdate ? TouchEvent::Kind::move
                                                                    : TouchEvent::Kind::end;
                if (screens.contains(touch.sourceid))
                    events.push_back({kind, touch.detail, now_s, {touch.event_x, touch.event_y}});
            }
            XFreeEventData(display, &cookie);
        }
        return events;
    }
};

TouchScreens::TouchScreens(GLFWwindow* window) : impl_(std::make_unique<Impl>(window)) {}
TouchScreens::~TouchScreens() = default;

bool TouchScreens::any() const { return !impl_->screens.empty(); }

std::vector<TouchEvent> TouchScreens::take(double now_s) { return impl_->take(now_s); }

}  // namespace tangi
