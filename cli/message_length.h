// message_length.h: how long a message may be.
#pragma once

#include <cstddef>

namespace tangi {

// [bytes] What is longer is cut: a file that is damaged may have its whole content in one name. A screen of a
// terminal has 1920.
constexpr std::size_t kMostOfMessage = 1500;

}  // namespace tangi
