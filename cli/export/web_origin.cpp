#include "cli/export/web_origin.h"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <string_view>

#include "cli/command.h"
#include "surface/base/words.h"

namespace tangi {

namespace {

constexpr std::size_t kLongestHost = 253;  // [bytes] RFC 1035, 2.3.4, without the root's point

[[noreturn]] void refuse(const std::string& words, std::string_view why) {
    throw UsageError(fmt::format("--embed-origin {}: {}", words, why));
}

// An address of numbers, as browsers write it; nothing where it is none.
std::optional<std::string> address_in(int family, const std::string& host) {
    std::array<unsigned char, 16> bytes{};
    std::array<char, INET6_ADDRSTRLEN> text{};
    if (::inet_pton(family, host.c_str(), bytes.data()) != 1) return {};
    return ::inet_ntop(family, bytes.data(), text.data(), text.size());
}

bool is_in_name(char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '.' || c == '_';
}

std::string host_as_sent(const std::string& words, const std::string& host) {
    if (host.starts_with('[')) {
        const auto address = address_in(AF_INET6, host.substr(1, host.size() - 2));
        if (!host.ends_with(']') || !address)
            refuse(words, host + " is no IPv6 address; write it as [2001:db8::1]");
        return "[" + *address + "]";
    }
    if (std::ranges::any_of(host, [](unsigned char c) { return c >= 0x80; }))
        refuse(words,
               "browsers send letters beyond ASCII in punycode; write xn--… as `location.origin` gives it in "
               "the "
               "browser's console on that site");
    for (const char c : host)
        if (!is_in_name(c))
            refuse(words, fmt::format("'{}' is in no name of a site; write it as https://museum.example", c));
    if (host.empty() || host.size() > kLongestHost || host.starts_with('.') ||
        host.find("..") != std::string::npos)
        refuse(words, "is no name of a site; write it as https://museum.example");
    const std::string last = host.substr(host.rfind('.') + 1);
    if (!last.empty() && std::ranges::all_of(last, [](char c) { return c >= '0' && c <= '9'; }) &&
        !address_in(AF_INET, host))
        refuse(words, host + " is no IPv4 address; write four numbers from 0 to 255, as 192.0.2.1");
    return host;
}

// ":8443"; empty where it is the scheme's own.
std::string port_as_sent(const std::string& words, const std::string& port, bool is_https) {
    if (port.empty()) return "";
    int number = 0;
    const auto [end, status] = std::from_chars(port.data() + 1, port.data() + port.size(), number);
    if (port.size() > 1 &&
        (status != std::errc() || end != port.data() + port.size() || number < 1 || number > 65535))
        refuse(words, fmt::format("{} is no port; write one from 1 to 65535, as :8443, or none", port));
    return port.size() == 1 || number == (is_https ? 443 : 80) ? "" : fmt::format(":{}", number);
}

}  // namespace

std::string origin_as_sent(const std::string& words) {
    const std::string text(without_blanks(words));
    if (text == "*") return text;
    const std::string lower = lower_case(text);
    const auto slashes = lower.find("://");
    const std::string scheme = lower.substr(0, slashes);
    if (slashes == std::string::npos)
        refuse(words, fmt::format("says neither https:// nor http://; write https://{}", lower));
    if (scheme != "https" && scheme != "http")
        refuse(words, scheme + ":// is no scheme of web pages; write https://museum.example, or http://");
    std::string site = lower.substr(slashes + 3);
    const std::string behind = site.substr(std::min(site.find_first_of("/?#\\"), site.size()));
    site.resize(site.size() - behind.size());
    if (site.find('@') != std::string::npos) refuse(words, "holds a user's name; leave it out, and the @");
    const auto bracket = site.find(']'), colon = site.find(':', bracket == std::string::npos ? 0 : bracket);
    const std::string port = colon == std::string::npos ? "" : site.substr(colon);
    site.resize(site.size() - port.size());
    const std::string sent =
        scheme + "://" + host_as_sent(words, site) + port_as_sent(words, port, scheme == "https");
    if (!behind.empty() && behind != "/")
        refuse(words, fmt::format("browsers send the site alone, without what is behind it; write {}", sent));
    return sent;
}

}  // namespace tangi
