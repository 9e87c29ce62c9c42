// pen_x11.cpp: pens as XInput 2 tells of them, and the mice beside them: raw events, seen by all clients.
#include <X11/Xlib.h>
#include <X11/extensions/XInput2.h>

#include <algorithm>
#include <map>
#include <utility>

#include "viewer/devices/pen.h"
#include "viewer/devices/x11_connection.h"

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
    struct Device {
        std::string name;
        std::optional<Pen> pen;  // else it is a mouse
    };
    X11Connection x{0};
    std::map<int, Device> devices;  // by their numbers; none where there is no pen
    bool lost = false;

    Impl() {
        if (!x.display()) return;
        x.select(0, XIAllDevices, {XI_HierarchyChanged});
        find();
    }

    // A pen, or a mouse; nothing where it is a touch screen or a touchpad's finger.
    std::optional<Device> device_of(const XIDeviceInfo& info) const {
        std::vector<PenAxis> axes;
        for (int c = 0; c < info.num_classes; ++c) {
            if (info.classes[c]->type == XITouchClass &&
                reinterpret_cast<const XITouchClassInfo*>(info.classes[c])->mode == XIDirectTouch)
                return {};
            if (info.classes[c]->type != XIValuatorClass) continue;
            const auto& axis = *reinterpret_cast<const XIValuatorClassInfo*>(info.classes[c]);
            axes.push_back({axis.number, text_of(x.display(), axis.label), axis.min, axis.max, axis.value});
        }
        Device device{info.name, {}};
        if (is_pen(axes)) device.pen.emplace(std::move(axes), is_eraser(info.name));
        return device;
    }

    // The devices that are there now. A pen that is known keeps its state.
    void find() {
        int count = 0;
        XIDeviceInfo* infos = XIQueryDevice(x.display(), XIAllDevices, &count);
        std::map<int, Device> found;
        for (int i = 0; infos && i < count; ++i) {
            const XIDeviceInfo& info = infos[i];
            if (info.use != XISlavePointer || !info.enabled) continue;
            const auto known = devices.find(info.deviceid);
            if (known != devices.end() && known->second.name == info.name)
                found.insert(*known);
            else if (auto device = device_of(info))
                found.emplace(info.deviceid, std::move(*device));
        }
        if (infos) XIFreeDeviceInfo(infos);
        for (const auto& [number, device] : devices)
            if (device.pen && device.pen->down() && !found.contains(number)) lost = true;
        // What mice do matters where there is a pen.
        if (std::ranges::none_of(found, [](const auto& device) { return device.second.pen.has_value(); }))
            found.clear();
        for (const auto& [number, device] : found)
            if (!devices.contains(number))
                x.select(0, number, {XI_RawMotion, XI_RawButtonPress, XI_RawButtonRelease});
        devices = std::move(found);
        XFlush(x.display());
    }

    void hear(const XIRawEvent& event, PenNews& news) {
        const auto found = devices.find(event.deviceid);
        if (found == devices.end()) return;
        DeviceStep step{.kind = event.evtype == XI_RawMotion        ? DeviceStep::Kind::move
                                : event.evtype == XI_RawButtonPress ? DeviceStep::Kind::press
                                                                    : DeviceStep::Kind::release,
                        .button = event.detail};
        constexpr int kFirstWheel = 4, kLastWheel = 7;
        if (step.kind != DeviceStep::Kind::move && step.button >= kFirstWheel && step.button <= kLastWheel)
            return;
        if (found->second.pen) {
            Pen& pen = *found->second.pen;
            ToldAxes told;
            const double* value = event.valuators.values;
            for (int bit = 0; bit < 8 * event.valuators.mask_len; ++bit)
                if (XIMaskIsSet(event.valuators.mask, bit)) told.emplace_back(bit, *value++);
            const bool tip = step.button == 1;  // others are on the barrel
            step.pen = tip && step.kind == DeviceStep::Kind::press     ? pen.press(told)
                       : tip && step.kind == DeviceStep::Kind::release ? pen.release(told)
                                                                       : pen.move(told);
        }
        news.steps.push_back(step);
    }

    PenNews take() {
        PenNews news;
        // What GLFW has heard, the server has sent to this connection, too; an answer comes behind it.
        if (!devices.empty()) XSync(x.display(), False);
        x.hear([&](int type, const void* data) {
            if (type == XI_HierarchyChanged)
                find();
            else
                hear(*static_cast<const XIRawEvent*>(data), news);
        });
        for (const auto& [number, device] : devices) news.down |= device.pen && device.pen->down();
        news.lost = std::exchange(lost, false);
        return news;
    }
};

PenDevices::PenDevices() : impl_(std::make_unique<Impl>()) {}
PenDevices::~PenDevices() = default;

PenNews PenDevices::take() { return impl_->take(); }

std::vector<std::string> PenDevices::names() const {
    std::vector<std::string> names;
    for (const auto& [number, device] : impl_->devices)
        if (device.pen) names.push_back(device.name);
    return names;
}

}  // namespace tangi
