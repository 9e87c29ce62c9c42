// display_profile_x11.cpp: the profile that a desktop has put on the screen: "ICC Profiles in X
// Specification" 0.4.
#include <X11/Xatom.h>
#include <X11/Xlib.h>

#include "viewer/render/display_profile.h"

namespace tangi {

std::optional<std::string> profile_of_the_screen() {
    Display* display = XOpenDisplay(nullptr);
    if (!display) return {};
    std::optional<std::string> icc;
    const Atom property = XInternAtom(display, "_ICC_PROFILE", True);
    if (property != 0) {
        Atom type = 0;
        int format = 0;
        unsigned long count = 0, left = 0;
        unsigned char* bytes = nullptr;
        constexpr long kMostWords = 16L << 20;  // 64 MB
        if (XGetWindowProperty(display, DefaultRootWindow(display), property, 0, kMostWords, False,
                               XA_CARDINAL, &type, &format, &count, &left, &bytes) == Success &&
            format == 8 && count > 0)
            icc.emplace(reinterpret_cast<const char*>(bytes), count);
        if (bytes) XFree(bytes);
    }
    XCloseDisplay(display);
    return icc;
}

}  // namespace tangi
