// program_server.cpp: a library to preload (LD_PRELOAD): the program stops before main(), and runs it in a
// fork of itself whenever it is asked to, by other arguments, in another folder, with other streams.
//
// A start costs what the loader takes for some 290 libraries, three quarters of what short commands take.
// Here that is done once for a program of tests (program_server.h asks). AFL calls the same a fork server.
//
//   TP_PROGRAM_SOCKET   number of the socket (SOCK_SEQPACKET) by which it is asked
//
// A request is one message: the count of arguments, the folder, the arguments, the environment, each ended by
// a zero byte; with it come stdout and stderr. The answer is the process's number (pid_t); it is an orphan by
// then, so that the nearest subreaper waits for it (PR_SET_CHILD_SUBREAPER).
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace {

using Main = int (*)(int, char**, char**);

Main main_of_program = nullptr;

constexpr size_t kLongest = 256 * 1024, kMostWords = 1024;

struct Request {
    char text[kLongest];
    char* words[kMostWords + 2];  // the arguments, null, the environment, null
    int count, streams[2];

    bool receive(int socket) {
        iovec bytes{text, sizeof text};
        alignas(cmsghdr) char control[CMSG_SPACE(sizeof streams)];
        msghdr message{};
        message.msg_iov = &bytes;
        message.msg_iovlen = 1;
        message.msg_control = control;
        message.msg_controllen = sizeof control;
        const ssize_t length = recvmsg(socket, &message, MSG_CMSG_CLOEXEC);
        const cmsghdr* files = CMSG_FIRSTHDR(&message);
        if (length <= 0 || !files) return false;
        memcpy(streams, CMSG_DATA(files), sizeof streams);
        count = atoi(text);
        folder_ = text + strlen(text) + 1;
        int at = 0;
        for (char* word = folder_ + strlen(folder_) + 1; word < text + length; word += strlen(word) + 1) {
            if (at == count) words[at++] = nullptr;
            if (at > static_cast<int>(kMostWords)) return false;
            words[at++] = word;
        }
        if (at == count) words[at++] = nullptr;
        words[at] = nullptr;
        return true;
    }

    void become() {
        if (*folder_ && chdir(folder_) != 0) _exit(126);
        dup2(streams[0], STDOUT_FILENO);
        dup2(streams[1], STDERR_FILENO);
        close(streams[0]);
        close(streams[1]);
        environ = words + count + 1;
    }

private:
    char* folder_;
};

// Comes back in the process that is to be the program.
void serve(int socket, Request& request) {
    auto* started = static_cast<pid_t*>(
        mmap(nullptr, sizeof(pid_t), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
    while (request.receive(socket)) {
        const pid_t between = fork();
        if (between == 0) {
            const pid_t program = fork();
            if (program == 0) {
                close(socket);
                munmap(started, sizeof(pid_t));
                return;
            }
            *started = program;
            _exit(0);
        }
        waitpid(between, nullptr, 0);
        close(request.streams[0]);
        close(request.streams[1]);
        if (send(socket, started, sizeof(pid_t), MSG_NOSIGNAL) < 0) break;
    }
    _exit(0);
}

int served_main(int count, char** words, char** environment) {
    const char* socket = getenv("TP_PROGRAM_SOCKET");
    if (!socket) return main_of_program(count, words, environment);
    static Request request;
    serve(atoi(socket), request);
    request.become();
    const int code = main_of_program(request.count, request.words, environ);
    // Not exit(): libraries' own threads, of which a fork has none, would be waited for (log4cplus, by way of
    // OpenImageIO). The first start of each program of tests is a common one and ends as such.
    fflush(nullptr);
    _exit(code);
}

}  // namespace

// NOLINTNEXTLINE(bugprone-reserved-identifier): the name is that of the C library.
extern "C" int __libc_start_main(Main main, int count, char** words, void (*begin)(), void (*end)(),
                                 void (*at_exit)(), void* stack_end) {
    main_of_program = main;
    const auto next = reinterpret_cast<decltype(&__libc_start_main)>(dlsym(RTLD_NEXT, "__libc_start_main"));
    return next(served_main, count, words, begin, end, at_exit, stack_end);
}
