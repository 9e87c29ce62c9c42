// touch_x11.cpp: fingers as XInput 2.2 tells of them, on a connection of its own.
#include <X11/Xlib.h>
#include <X11/extensions/XInput2.h>
#include <dlfcn.h>

#include <set>

#include "viewer/devices/touch.h"
#include "viewer/devices/x11_connection.h"

namespace tangi {

namespace {

// The window's number; 0 where GLFW was built for Wayland, and has no such function.
Window number_of(GLFWwindow* window) {
    using Ask = Window (*)(GLFWwindow*);
    const auto ask = reinterpret_cast<Ask>(::dlsym(RTLD_DEFAULT, "glfwGetX11Window"));
    return ask && window ? ask(window) : 0;
}

}  // namespace

struct TouchScreens::Impl {
    X11Connection x{2};
    std::set<int> screens;  // devices; touch pads are none

    explicit Impl(GLFWwindow* glfw_window) {
        const Window window = number_of(glfw_window);
        if (window == 0 || !x.display()) return;
        x.select(0, XIAllDevices, {XI_HierarchyChanged});
        x.select(window, XIAllMasterDevices, {XI_TouchBegin, XI_TouchUpdate, XI_TouchEnd});
        find();
    }

    void find() {
        screens.clear();
        int count = 0;
        XIDeviceInfo* devices = XIQueryDevice(x.display(), XIAllDevices, &count);
        for (int i = 0; devices && i < count; ++i)
            for (int c = 0; c < devices[i].num_classes; ++c) {
                if (devices[i].classes[c]->type != XITouchClass) continue;
                const auto& touch = *reinterpret_cast<const XITouchClassInfo*>(devices[i].classes[c]);
                if (touch.mode == XIDirectTouch && devices[i].use == XISlavePointer)
                    screens.insert(devices[i].deviceid);
            }
        if (devices) XIFreeDeviceInfo(devices);
        XFlush(x.display());
    }

    std::vector<TouchEvent> take(double now_s) {
        std::vector<TouchEvent> events;
        x.hear([&](int type, const void* data) {
            if (type == XI_HierarchyChanged) {
                find();
                return;
            }
            const auto& touch = *static_cast<const XIDeviceEvent*>(data);
            const auto kind = type == XI_TouchBegin    ? TouchEvent::Kind::begin
                              : type == XI_TouchUpdate ? TouchEvent::Kind::move
                                                       : TouchEvent::Kind::end;
            if (screens.contains(touch.sourceid))
                events.push_back({kind, touch.detail, now_s, {touch.event_x, touch.event_y}});
        });
        return events;
    }
};

TouchScreens::TouchScreens(GLFWwindow* window) : impl_(std::make_unique<Impl>(window)) {}
TouchScreens::~TouchScreens() = default;

bool TouchScreens::any() const { return !impl_->screens.empty(); }

std::vector<TouchEvent> TouchScreens::take(double now_s) { return impl_->take(now_s); }

}  // namespace tangi
