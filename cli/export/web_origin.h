// web_origin.h: a site as browsers name it to the pages that it asks and tells.
#pragma once

#include <string>

namespace tangi {

// What browsers send as the origin of a site (RFC 6454, 6.2; WHATWG URL, 3.5 and 4.1): scheme and host in
// small letters, a port where it is not the scheme's own, and nothing behind. Other ways to write the same
// site become this one: "HTTPS://Museum.Example:443/" is https://museum.example. "*" stays. Throws UsageError
// about --embed-origin that says what to write instead.
std::string origin_as_sent(const std::string& words);

}  // namespace tangi
