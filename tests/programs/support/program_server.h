// program_server.h: starts the program without the loader's work for each start, by a fork of one that stands
// before main() (program_server.cpp).
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace tangi {

class ProgramServer {
public:
    // The one of this program of tests, for programs with these libraries preloaded. Null the first time:
    // once the program is started as users start it. Null with the sanitizers.
    static ProgramServer* with_preloaded(const std::string& libraries) {
        if (*TP_PROGRAM_SERVER == '\0') return nullptr;
        static std::map<std::string, std::unique_ptr<ProgramServer>> all;
        const auto [found, is_first] = all.try_emplace(libraries);
        if (!is_first && !found->second) found->second = std::make_unique<ProgramServer>(libraries);
        return found->second.get();
    }

    explicit ProgramServer(const std::string& libraries) {
        int ends[2];
        if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
            throw std::runtime_error("socketpair");
        socket_ = ends[0];
        ::prctl(PR_SET_CHILD_SUBREAPER, 1);
        const std::string preloaded = libraries + ":" + TP_PROGRAM_SERVER, number = std::to_string(ends[1]);
        if (::fork() == 0) {
            ::fcntl(ends[1], F_SETFD, 0);
            ::signal(SIGINT, SIG_DFL);  // as each other start has it
            ::setenv("LD_PRELOAD", preloaded.c_str(), 1);
            ::setenv("TP_PROGRAM_SOCKET", number.c_str(), 1);
            ::execl(TP_PROGRAM, TP_PROGRAM, nullptr);
            ::_exit(127);
        }
        ::close(ends[1]);
    }
    ~ProgramServer() { ::close(socket_); }  // which ends it
    ProgramServer(const ProgramServer&) = delete;
    ProgramServer& operator=(const ProgramServer&) = delete;

    // The number of a process to be waited for; streams stay the caller's.
    pid_t start(const std::vector<std::string>& arguments, const std::vector<std::string>& environment,
                const std::string& folder, int out, int err) const {
        std::string text = std::to_string(arguments.size()) + '\0' + folder + '\0';
        for (const auto* words : {&arguments, &environment})
            for (const std::string& word : *words) text += word + '\0';
        const int streams[] = {out, err};
        iovec bytes{text.data(), text.size()};
        alignas(cmsghdr) char control[CMSG_SPACE(sizeof streams)] = {};
        msghdr message{};
        message.msg_iov = &bytes;
        message.msg_iovlen = 1;
        message.msg_control = control;
        message.msg_controllen = sizeof control;
        cmsghdr* files = CMSG_FIRSTHDR(&message);
        files->cmsg_level = SOL_SOCKET;
        files->cmsg_type = SCM_RIGHTS;
        files->cmsg_len = CMSG_LEN(sizeof streams);
        std::memcpy(CMSG_DATA(files), streams, sizeof streams);
        pid_t started = -1;
        if (::sendmsg(socket_, &message, MSG_NOSIGNAL) < 0 ||
            ::recv(socket_, &started, sizeof started, 0) <= 0)
            throw std::runtime_error("the program that is to start others has ended");
        return started;
    }

private:
    int socket_ = -1;
};

}  // namespace tangi
