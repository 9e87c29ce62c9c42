// x11_connection.h: a connection to the X server beside GLFW's, to hear of pens and fingers (XInput 2).
//
// A device may be gone by the time it is asked for, and another program may hear already what is asked for:
// on these connections that is no error. Xlib would end the program; its handler is one for all connections
// of the process, so it stands here once, and hands on what is not ours.
#pragma once

#include <functional>
#include <vector>

struct _XDisplay;

namespace tangi {

class X11Connection {
public:
    // No connection where there is no X server, or where it does not speak XInput 2 of this minor version at
    // least.
    explicit X11Connection(int minor_version);
    ~X11Connection();
    X11Connection(const X11Connection&) = delete;
    X11Connection& operator=(const X11Connection&) = delete;

    _XDisplay* display() const { return display_; }  // null: there is none

    // Hears these XInput events (XI_...) of a device in a window; 0: the root.
    void select(unsigned long window, int device, const std::vector<int>& events) const;

    // Each XInput event that has come since: its type (XI_...) and data.
    void hear(const std::function<void(int type, const void* data)>& event);

private:
    _XDisplay* display_ = nullptr;
    int opcode_ = 0;
};

}  // namespace tangi
