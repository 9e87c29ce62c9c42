// inflate.cpp: what zlib has packed (RFC 1950, 1951), unpacked: surface/file/deflated.h where there is no
// libdeflate.
#include <array>
#include <cstddef>
#include <cstring>
#include <vector>

#include "surface/file/deflated.h"

namespace tangi {

namespace {

struct Damaged {};

class Bits {
public:
    explicit Bits(std::string_view bytes) : bytes_(bytes) {}

    // 56 bits and more are there to be seen from here on, zeros after the end.
    void fill() {
        if (bytes_.size() - at_ < sizeof held_) return fill_by_bytes();
        std::uint64_t next;
        std::memcpy(&next, bytes_.data() + at_, sizeof next);  // the lowest byte first, as WebAssembly has it
        held_ |= next << held_count_;
        at_ += static_cast<std::size_t>((63 - held_count_) >> 3);
        held_count_ |= 56;
    }
    // The next ones, the lowest first, of those that fill() has got.
    std::uint64_t seen(int count) const { return held_ & ((std::uint64_t{1} << count) - 1); }
    void drop(int count) {
        if (count > held_count_) throw Damaged();
        held_ >>= count;
        held_count_ -= count;
    }
    unsigned taken(int count) {
        const auto value = static_cast<unsigned>(seen(count));
        drop(count);
        return value;
    }
    unsigned take(int count) {
        fill();
        return taken(count);
    }
    void to_byte() { drop(held_count_ % 8); }

private:
    void fill_by_bytes() {
        for (; held_count_ < 56 && at_ < bytes_.size(); held_count_ += 8)
            held_ |= std::uint64_t{static_cast<unsigned char>(bytes_[at_++])} << held_count_;
    }

    std::string_view bytes_;
    std::size_t at_ = 0;
    std::uint64_t held_ = 0;  // bits beyond held_count_ are those that follow, or zeros
    int held_count_ = 0;
};

// What is unpacked, in room that is there from the beginning.
class Unpacked {
public:
    explicit Unpacked(std::size_t most_bytes) : bytes_(most_bytes, '\0') {}

    void add(char byte) {
        if (size_ == bytes_.size()) throw Damaged();
        bytes_[size_++] = byte;
    }
    // So many of those that lie so far back, which may be some of these.
    void repeat(std::size_t back, std::size_t count) {
        if (back > size_ || count > bytes_.size() - size_) throw Damaged();
        char* to = bytes_.data() + size_;
        const char* from = to - back;
        size_ += count;
        if (back < kWord || bytes_.size() - size_ < kWord) {
            for (std::size_t i = 0; i < count; ++i) to[i] = from[i];
            return;
        }
        for (std::size_t i = 0; i < count; i += kWord) {  // some more, which are written over
            std::uint64_t word;
            std::memcpy(&word, from + i, kWord);
            std::memcpy(to + i, &word, kWord);
        }
    }
    std::string all() {
        bytes_.resize(size_);
        return std::move(bytes_);
    }

private:
    static constexpr std::size_t kWord = sizeof(std::uint64_t);
    std::string bytes_;
    std::size_t size_ = 0;
};

constexpr int kMostBits = 15;  // of a code

// A canonical Huffman code (RFC 1951, 3.2.2): symbols in the order of their lengths, and how many have each;
// of short codes, which symbol the next bits begin with.
class HuffmanCode {
public:
    explicit HuffmanCode(const std::vector<int>& lengths) : symbols_(lengths.size()) {
        for (const int length : lengths) ++count_[static_cast<std::size_t>(length)];
        count_[0] = 0;
        std::array<int, kMostBits + 2> first{}, code{};
        for (std::size_t l = 1; l <= kMostBits; ++l) {
            first[l + 1] = first[l] + count_[l];
            code[l + 1] = (code[l] + count_[l]) << 1;
        }
        for (std::size_t symbol = 0; symbol < lengths.size(); ++symbol) {
            const auto length = static_cast<std::size_t>(lengths[symbol]);
            if (length == 0) continue;
            symbols_[static_cast<std::size_t>(first[length]++)] = static_cast<int>(symbol);
            remember(static_cast<int>(symbol), lengths[symbol], code[length]++);
        }
    }
    // Of the bits that fill() has got: up to kMostBits of them.
    int next(Bits& bits) const {
        const Short found = short_[bits.seen(kShortBits)];
        if (found.length == 0) return next_by_bits(bits);
        bits.drop(found.length);
        return found.symbol;
    }

private:
    static constexpr int kShortBits = 11;
    struct Short {
        std::int16_t symbol = 0, length = 0;
    };

    void remember(int symbol, int length, int code) {
        if (length > kShortBits) return;
        int turned = 0;  // codes come with their highest bit first
        for (int i = 0; i < length; ++i) turned |= (code >> i & 1) << (length - 1 - i);
        for (int i = turned; i < 1 << kShortBits; i += 1 << length)
            short_[static_cast<std::size_t>(i)] = {static_cast<std::int16_t>(symbol),
                                                   static_cast<std::int16_t>(length)};
    }
    int next_by_bits(Bits& bits) const {
        int code = 0, first = 0, index = 0;
        for (std::size_t length = 1; length <= kMostBits; ++length) {
            code |= static_cast<int>(bits.taken(1));
            if (code - first < count_[length])
                return symbols_[static_cast<std::size_t>(index + code - first)];
            index += count_[length];
            first = (first + count_[length]) << 1;
            code <<= 1;
        }
        throw Damaged();
    }

    std::array<int, kMostBits + 1> count_{};
    std::vector<int> symbols_;
    std::array<Short, 1 << kShortBits> short_{};
};

constexpr std::array kLengthBase = {3,  4,  5,  6,  7,  8,  9,  10, 11,  13,  15,  17,  19,  23, 27,
                                    31, 35, 43, 51, 59, 67, 83, 99, 115, 131, 163, 195, 227, 258};
constexpr std::array kLengthBits = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2,
                                    2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0};
constexpr std::array kFarBase = {1,    2,    3,    4,    5,    7,    9,    13,    17,    25,
                                 33,   49,   65,   97,   129,  193,  257,  385,   513,   769,
                                 1025, 1537, 2049, 3073, 4097, 6145, 8193, 12289, 16385, 24577};
constexpr std::array kFarBits = {0, 0, 0, 0, 1, 1, 2, 2,  3,  3,  4,  4,  5,  5,  6,
                                 6, 7, 7, 8, 8, 9, 9, 10, 10, 11, 11, 12, 12, 13, 13};

void unpack_codes(Bits& bits, const HuffmanCode& literals, const HuffmanCode& distances, Unpacked& out) {
    for (;;) {
        bits.fill();  // enough for two codes and the bits of a length, or for those of a distance
        auto symbol = static_cast<std::size_t>(literals.next(bits));
        if (symbol < 256) {
            out.add(static_cast<char>(symbol));
            symbol = static_cast<std::size_t>(literals.next(bits));
        }
        if (symbol < 256) {
            out.add(static_cast<char>(symbol));
            continue;
        }
        if (symbol == 256) return;
        if (symbol - 257 >= kLengthBase.size()) throw Damaged();
        const std::size_t length =
            static_cast<std::size_t>(kLengthBase[symbol - 257]) + bits.taken(kLengthBits[symbol - 257]);
        bits.fill();
        const auto far = static_cast<std::size_t>(distances.next(bits));
        if (far >= kFarBase.size()) throw Damaged();
        out.repeat(static_cast<std::size_t>(kFarBase[far]) + bits.taken(kFarBits[far]), length);
    }
}

void unpack_dynamic(Bits& bits, Unpacked& out) {
    constexpr std::array kOrder = {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
    const unsigned literals = bits.take(5) + 257, distances = bits.take(5) + 1, codes = bits.take(4) + 4;
    std::vector<int> lengths(19);
    for (unsigned i = 0; i < codes; ++i)
        lengths[static_cast<std::size_t>(kOrder[i])] = static_cast<int>(bits.take(3));
    const HuffmanCode of_lengths(lengths);
    std::vector<int> all;
    while (all.size() < literals + distances) {
        bits.fill();
        const int symbol = of_lengths.next(bits);
        if (symbol < 16) {
            all.push_back(symbol);
            continue;
        }
        if (symbol == 16 && all.empty()) throw Damaged();
        const int value = symbol == 16 ? all.back() : 0;
        const unsigned times = symbol == 16   ? 3 + bits.take(2)
                               : symbol == 17 ? 3 + bits.take(3)
                                              : 11 + bits.take(7);
        all.insert(all.end(), times, value);
    }
    if (all.size() > literals + distances) throw Damaged();
    const auto middle = all.begin() + static_cast<std::ptrdiff_t>(literals);
    unpack_codes(bits, HuffmanCode({all.begin(), middle}), HuffmanCode({middle, all.end()}), out);
}

void unpack_fixed(Bits& bits, Unpacked& out) {
    std::vector<int> lengths(288, 8);
    for (std::size_t i = 144; i < 280; ++i) lengths[i] = i < 256 ? 9 : 7;
    unpack_codes(bits, HuffmanCode(lengths), HuffmanCode(std::vector<int>(30, 5)), out);
}

void unpack_stored(Bits& bits, Unpacked& out) {
    bits.to_byte();
    const unsigned length = bits.take(16);
    bits.take(16);  // the same, inverted
    for (unsigned i = 0; i < length; ++i) out.add(static_cast<char>(bits.take(8)));
}

}  // namespace

std::optional<std::string> inflated(std::string_view packed, std::size_t most_bytes) {
    try {
        Bits bits(packed);
        if ((bits.take(8) & 15) != 8) return {};
        bits.take(8);
        Unpacked out(most_bytes);
        for (bool last = false; !last;) {
            last = bits.take(1) == 1;
            switch (bits.take(2)) {
                case 0:
                    unpack_stored(bits, out);
                    break;
                case 1:
                    unpack_fixed(bits, out);
                    break;
                case 2:
                    unpack_dynamic(bits, out);
                    break;
                default:
                    return {};
            }
        }
        return out.all();
    } catch (const Damaged&) {
        return {};
    }
}

}  // namespace tangi
