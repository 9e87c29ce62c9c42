// damaged_bytes.h: files as copies, disks, editors and attackers leave them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "tests/support/test_support.h"

namespace tangi {

// Numbers as attackers write them into headers: the largest of their kind, and those next to it.
inline std::string odd_number(Random& random) {
    constexpr std::array<std::uint32_t, 10> odd = {0,      1,          0x7f,       0x80,       0xff,
                                                   0xffff, 0x7fffffff, 0x80000000, 0xffffffff, 0xfffffff0};
    const std::uint32_t number = odd[static_cast<std::size_t>(random.below(odd.size()))];
    const int bytes = 1 << random.below(3);
    const bool big_endian = random.uniform() < 0.5;
    std::string text;
    for (int i = 0; i < bytes; ++i)
        text += static_cast<char>(number >> 8 * (big_endian ? bytes - 1 - i : i) & 255);
    return text;
}

// Words as they are put into texts by hand or by a broken program.
inline std::string odd_word(Random& random) {
    constexpr std::array<std::string_view, 14> odd = {"1e400", "-1e308", "NaN", "1e30",  "-0",
                                                      "null",  "true",   "[]",  "{}",    "\"\"",
                                                      "[[[[",  "-1",     "0",   "1e-320"};
    if (random.below(8) == 0)
        return std::string(static_cast<std::size_t>(1) << random.below(13), "x[0 "[random.below(4)]);
    return std::string(odd[static_cast<std::size_t>(random.below(odd.size()))]);
}

// Replaces a word or number of a text by another.
inline void exchange_word(std::string& bytes, std::size_t at, Random& random) {
    constexpr std::string_view ends = " ,:[]{}\n\"<>";
    const std::size_t begin = bytes.find_last_of(ends, at), end = bytes.find_first_of(ends, at);
    const std::size_t from = begin == std::string::npos ? 0 : begin + 1;
    bytes.replace(from, end == std::string::npos ? std::string::npos : std::max(end, from) - from,
                  odd_word(random));
}

// One of the ways in which copies, disks and editors damage files.
inline std::string damaged(std::string bytes, Random& random) {
    const auto place = [&] {
        // The beginning says what the rest is: it is hit as often.
        const int end = static_cast<int>(bytes.size());
        return static_cast<std::size_t>(random.below(random.uniform() < 0.5 ? std::min(end, 2000) : end));
    };
    const auto any = [&] { return static_cast<char>(random.below(256)); };
    for (int times = 1 + random.below(3); times > 0 && !bytes.empty(); --times) {
        const std::size_t at = place(), length = 1 + static_cast<std::size_t>(random.below(8));
        switch (random.below(9)) {
            case 0:
                bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8)));
                break;
            case 1:
                bytes[at] = any();
                break;
            case 2:
                bytes.resize(at);
                break;
            case 3:
                bytes.erase(at, length);
                break;
            case 4:
                bytes.insert(at, bytes.substr(place(), length));
                break;
            case 5:
                bytes.replace(at, std::min(length, bytes.size() - at), length,
                              "\0\xff"
                              "9-e"[random.below(5)]);
                break;
            case 6: {
                const std::string number = odd_number(random);
                bytes.replace(at, std::min(number.size(), bytes.size() - at), number);
                break;
            }
            case 7:
                exchange_word(bytes, at, random);
                break;
            default:
                bytes.insert(at, 1, any());
        }
    }
    return bytes;
}

}  // namespace tangi
