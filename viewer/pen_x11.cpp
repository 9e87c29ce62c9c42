// pen_x11.cpp: pens as XInput 2 tells of them: raw events of the devices that press, seen by all clients.
#include <X11/Xlib.h>
#include <X11/extensions/XInput2.h>

#include <map>
#include <utility>

#include "viewer/pen.h"
#include "viewer/x11_connection.h"

namespace tangi {

namespace {

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
    X11Connection x{0};
    std::map<int, Pen> pens;  // by the device's number
    bool lost = false;

    Impl() {
        if (!x.display()) return;
        x.select(0, XIAllDevices, {XI_HierarchyChanged});
        find();
    }

    // The pens that are there now. One that is known keeps its state.
    void find() {
        int count = 0;
        XIDeviceInfo* devices = XIQueryDevice(x.display(), XIAllDevices, &count);
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
                    {axis.number, text_of(x.display(), axis.label), axis.min, axis.max, axis.value});
            }
            if (!is_pen(pen.axes)) continue;
            x.select(0, device.deviceid, {XI_RawMotion, XI_RawButtonPress, XI_RawButtonRelease});
            found.emplace(device.deviceid, std::move(pen));
        }
        if (devices) XIFreeDeviceInfo(devices);
        for (const auto& [number, pen] : pens)
            if (pen.down && !found.contains(number)) lost = true;
        pens = std::move(found);
        XFlush(x.display());
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
        x.hear([&](int type, const void* data) {
            if (type == XI_HierarchyChanged)
                find();
            else
                hear(*static_cast<const XIRawEvent*>(data), news);
        });
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
