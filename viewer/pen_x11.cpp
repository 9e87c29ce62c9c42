// pen_x11.cpp: pens as XInput 2 tells of them: raw events of the devices that press, seen by all clients.
#include <X11/Xlib.h>
#include <X11/extensions/XInput2.h>

#include <map>
#include <utility>

#include "viewer/pen.h"

namespace tangi {

namespace {

// A pen may be gone by the time it is asked for: on this connection that is no error. (Xlib would end the
// program; its handler is one for all connections.)
Display* pens_display = nullptr;
XErrorHandler other_errors = nullptr;

int on_error(Display* display, XErrorEvent* error) {
    if (display == pens_display) return 0;
    return other_errors ? other_errors(display, error) : 0;
}

std::string text_of(Display* display, Atom atom) {
    if (atom == 0) return {};
    char* name = XGetAtomName(display, atom);
    if (!name) return {};
    std::string text = name;
    XFree(name);
    return text;
}

}  // namespace

struct PenDevices::Impl {
    struct Pen {
        std::string name;
        std::vector<PenAxis> axes;
        bool eraser = false, down = false;
    };
    Display* display = nullptr;
    int opcode = 0;
    std::map<int, Pen> pens;  // by the device's number
    bool lost = false;

    Impl() {
        display = XOpenDisplay(nullptr);
        if (!display) return;
        pens_display = display;
        other_errors = XSetErrorHandler(on_error);
        int event = 0, error = 0, major = 2, minor = 2;
        if (!XQueryExtension(display, "XInputExtension", &opcode, &event, &error) ||
            XIQueryVersion(display, &major, &minor) != Success) {
            close();
            return;
        }
        select(XIAllDevices, {XI_HierarchyChanged});
        find();
    }
    ~Impl() { close(); }

    void close() {
        if (!display) return;
        XSync(display, True);
        XSetErrorHandler(other_errors);
        XCloseDisplay(display);
        pens_display = display = nullptr;
    }

    void select(int device, const std::vector<int>& events) const {
        std::vector<unsigned char> bits(XIMaskLen(XI_LASTEVENT), 0);
        for (const int one : events) XISetMask(bits.data(), one);
        XIEventMask mask{device, static_cast<int>(bits.size()), bits.data()};
        XISelectEvents(display, DefaultRootWindow(display), &mask, 1);
    }

    // The pens that are there now. One that is known keeps its state.
    void find() {
        int count = 0;
        XIDeviceInfo* devices = XIQueryDevice(display, XIAllDevices, &count);
        std::map<int, Pen> found;
        for (int i = 0; devices && i < count; ++i) {
            const XIDeviceInfo& device = devices[i];
            if (device.use != XISlavePointer || !device.enabled) continue;
            const auto known = pens.find(device.deviceid);
            if (known != pens.end() && known->second.name == device.name) {
                found.insert(*known);
                continue;
            }
            Pen pen{device.name, {}, is_eraser(device.name), false};
            for (int c = 0; c < device.num_classes; ++c) {
                if (device.classes[c]->type != XIValuatorClass) continue;
                const auto& axis = *reinterpret_cast<const XIValuatorClassInfo*>(device.classes[c]);
                pen.axes.push_back(
                    {axis.number, text_of(display, axis.label), axis.min, axis.max, axis.value});
            }
            if (!is_pen(pen.axes)) continue;
            select(device.deviceid, {XI_RawMotion, XI_RawButtonPress, XI_RawButtonRelease});
            found.emplace(device.deviceid, std::move(pen));
        }
        if (devices) XIFreeDeviceInfo(devices);
        for (const auto& [number, pen] : pens)
            if (pen.down && !found.contains(number)) lost = true;
        pens = std::move(found);
        XFlush(display);
    }

    void hear(const XIRawEvent& event, PenNews& news) {
        const auto found = pens.find(event.deviceid);
        if (found == pens.end()) return;
        Pen& pen = found->second;
        const double* value = event.valuators.values;
        for (int bit = 0; bit < 8 * event.valuators.mask_len; ++bit) {
            if (!XIMaskIsSet(event.valuators.mask, bit)) continue;
            for (PenAxis& axis : pen.axes)
                if (axis.number == bit) axis.value = *value;
            ++value;
        }
        if (event.evtype == XI_RawMotion) news.samples.push_back(pen_sample(pen.axes, pen.eraser));
        if (event.evtype != XI_RawMotion && event.detail == 1) {
            pen.down = event.evtype == XI_RawButtonPress;
            if (pen.down) news.samples.push_back(pen_sample(pen.axes, pen.eraser));
        }
    }

    PenNews take() {
        PenNews news;
        if (!display) return news;
        while (XPending(display) > 0) {
            XEvent event;
            XNextEvent(display, &event);
            XGenericEventCookie& cookie = event.xcookie;
            if (cookie.type != GenericEvent || cookie.extension != opcode) continue;
            if (!XGetEventData(display, &cookie)) continue;
            if (cookie.evtype == XI_HierarchyChanged)
                find();
            else
                hear(*static_cast<const XIRawEvent*>(cookie.data), news);
            XFreeEventData(display, &cookie);
        }
        for (const auto& [number, pen] : pens) news.down |= pen.down;
        news.lost = std::exchange(lost, false);
        return news;
    }
};

PenDevices::PenDevices() : impl_(std::make_unique<Impl>()) {}
PenDevices::~PenDevices() = default;

PenNews PenDevices::take() { return impl_->take(); }

std::vector<std::string> PenDevices::names() const {
    std::vector<std::string> names;
    for (const auto& [number, pen] : impl_->pens) names.push_back(pen.name);
    return names;
}

}  // namespace tangi
