// small_disk.h: a disk of its own, in memory, that can be filled, and made read-only.
#pragma once

#include <fmt/format.h>
#include <sys/mount.h>

#include <fstream>

#include "tests/support/test_support.h"

namespace tangi {

class SmallDisk {
public:
    // There is none where the tests may not mount one.
    explicit SmallDisk(int megabytes)
        : is_there_(::mount("none", folder_.path().c_str(), "tmpfs", 0,
                            fmt::format("size={}m", megabytes).c_str()) == 0) {}
    ~SmallDisk() {
        if (is_there_) ::umount2(folder_.path().c_str(), MNT_DETACH);
    }
    SmallDisk(const SmallDisk&) = delete;
    SmallDisk& operator=(const SmallDisk&) = delete;

    bool is_there() const { return is_there_; }
    std::filesystem::path operator/(const std::string& name) const { return folder_.path() / name; }

    // By a file beside the others. What a file has of its last page (4 KiB) it can still fill.
    void fill() const {
        std::ofstream stream(filler(), std::ios::binary);
        const std::string block(4096, 'x');
        while (stream.write(block.data(), static_cast<std::streamsize>(block.size())).flush()) {
        }
    }
    void make_room() const { std::filesystem::remove(filler()); }
    void make_read_only() const {
        if (::mount("none", folder_.path().c_str(), nullptr, MS_REMOUNT | MS_RDONLY, nullptr) != 0)
            throw std::runtime_error("test cannot make its disk read-only");
    }

private:
    std::filesystem::path filler() const { return folder_ / "filler"; }

    TestDir folder_;
    bool is_there_;
};

}  // namespace tangi
