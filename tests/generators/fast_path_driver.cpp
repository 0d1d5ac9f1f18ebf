// Feeds what stdin says to the fast path of a core, without ROS, and writes what it did.
//
// "d SIZE\n" and so many bytes: a datagram that arrives, "k SIZE\n" one with more behind it. "m SIZE NUMBER\n" and bytes: a message of
// ROS. Both translations copy what they are given, if it begins with the octet of its kind.
#include <arpa/inet.h>
#include <sys/eventfd.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include "fastpath.hpp"

namespace {

std::string message_of_ros;
std::uint64_t number_of_ros = 0;
std::string published;

void* allocate(std::size_t size, void*) { return std::malloc(size); }
void release(void* data, void*) { std::free(data); }
void* reallocate(void* data, std::size_t size, void*) { return std::realloc(data, size); }
void* zeroed(std::size_t count, std::size_t size, void*) { return std::calloc(count, size); }
jausml::Allocator allocator() { return {allocate, release, reallocate, zeroed, nullptr}; }

int publish(const void*, const jausml::Serialized* message, void*) {
    published.assign(reinterpret_cast<const char*>(message->data), message->size);
    return published.size() > 2 && published[2] == 'R' ? 1 : 0;  // one that ROS refuses
}

int take(const void*, jausml::Serialized* into, jausml::MessageInfo* info, void*) {
    if (number_of_ros == 0) return 401;
    if (into->capacity < message_of_ros.size()) {
        into->data = static_cast<std::uint8_t*>(std::realloc(into->data, message_of_ros.size()));
        into->capacity = message_of_ros.size();
    }
    std::memcpy(into->data, message_of_ros.data(), message_of_ros.size());
    into->size = message_of_ros.size();
    info->number = number_of_ros;
    number_of_ros = 0;
    return 0;
}

void forget_error() {}

std::int64_t copy(const std::uint8_t* data, std::size_t size, const jausml::Live*,
                  jausml::Made* made) {
    static std::vector<std::uint8_t> out;
    if (size > 2 && data[2] == 'G') return jausml::GIVES_WAY;
    out.assign(data, data + size);
    *made = {out.data(), 0};
    return static_cast<std::int64_t>(size);
}

std::string line() {
    std::string found;
    for (int each = std::getchar(); each != '\n' && each != EOF; each = std::getchar())
        found.push_back(static_cast<char>(each));
    return found;
}

std::string bytes(std::size_t size) {
    std::string found(size, '\0');
    if (size != 0 && std::fread(&found[0], 1, size, stdin) != size) std::exit(3);
    return found;
}

int bound(sockaddr_in& at) {
    const int sock = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0);
    const int room = 1 << 21;
    setsockopt(sock, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof at;
    if (bind(sock, reinterpret_cast<sockaddr*>(&at), sizeof at) != 0 ||
        getsockname(sock, reinterpret_cast<sockaddr*>(&at), &size) != 0)
        std::exit(3);
    return sock;
}

void hex(const std::uint8_t* data, std::size_t size) {
    for (std::size_t at = 0; at < size; ++at) std::printf("%02x", data[at]);
}

}  // namespace

int main(int count, char**) {
    const jausml::Ros ros{publish, take, forget_error, allocator};
    const jausml::Translation translation{copy, nullptr, 0};
    sockaddr_in bridge{}, peer{};
    const int in = bound(bridge), out = bound(peer);
    const int epoll = epoll_create1(0), announced = eventfd(0, EFD_NONBLOCK);
    for (const int each : {in, announced}) {
        epoll_event event{};
        event.events = EPOLLIN;
        event.data.fd = each;
        epoll_ctl(epoll, EPOLL_CTL_ADD, each, &event);
    }
    jausml::Core* const core = jausml_core(&ros, epoll);
    jausml_core_listen(core, in, 100000);
    for (const bool is_event : {false, true}) {
        jausml::Route route{};
        route.source = 0x00010101;
        route.destination = 0x0001010A;
        route.host = INADDR_LOOPBACK;
        route.port = ntohs(peer.sin_port);
        route.code = 0xD101;
        route.flags = 1;
        route.is_event = is_event ? 1 : 0;
        route.event = is_event ? 3 : 0;
        route.is_ordered = is_event ? 0 : 1;
        route.index = is_event ? 1 : 0;
        route.translation = &translation;
        const std::uint16_t known[] = {7, 8};
        if (jausml_core_add(core, &route, known, 2) == nullptr) return 3;
    }
    std::atomic<std::uint64_t> numbers{65530};
    jausml::Destination to{};
    to.host = INADDR_LOOPBACK;
    to.port = ntohs(peer.sin_port);
    to.flags = 1;
    to.sock = in;
    to.destination = 0x00010101;
    to.source = 0x0001010A;
    to.longest = 100;
    to.lifetime = 1e12;
    to.numbers = &numbers;
    jausml::Subscription subscription{nullptr, &translation, &to, announced, 0, 0, 50, 0};
    jausml::Pending* const pending = jausml_core_subscribe(core, &subscription);
    jausml::Waited waited{};
    // With an argument, another thread stops the core again and again, as Python may at any time.
    std::atomic<bool> goes_on{count > 1};
    std::thread other([core, &goes_on, &numbers] {
        while (goes_on) {
            jausml_core_stop(core);
            jausml_next_number(&numbers);
        }
    });
    for (std::string words = line(); !words.empty(); words = line()) {
        const bool is_datagram = words[0] != 'm';
        std::size_t read = 0;
        const std::size_t size = std::stoul(words.substr(2), &read);
        const std::string data = bytes(size);
        if (is_datagram) {
            sendto(out, data.data(), data.size(), 0, reinterpret_cast<sockaddr*>(&bridge),
                   sizeof bridge);
        } else {
            message_of_ros = data;
            number_of_ros = std::stoull(words.substr(2 + read));
            eventfd_write(announced, 1);
        }
        if (words[0] == 'k') {
            std::printf("kept\n");
            continue;
        }
        jausml_core_start(core);
        jausml_core_wait(core, 0.0, 1e300, &waited);
        std::printf("%zu %zu", waited.ready_count, waited.taken_count + waited.sent_count);
        if (waited.taken_count == 1) {
            std::printf(" %u %u ", waited.taken[0].index, waited.taken[0].number);
            hex(waited.taken[0].data, waited.taken[0].size);
        }
        if (!is_datagram) {
            if (waited.ready_count == 1) {
                std::printf(" %zu", pending->size);
                subscription.expected = pending->number + 1;
            }
            std::uint8_t buffer[65536];
            for (ssize_t got = 0; (got = recv(out, buffer, sizeof buffer, 0)) > 0;) {
                std::printf(" ");
                hex(buffer, static_cast<std::size_t>(got));
            }
        }
        std::uint8_t first = 0;
        do {
            for (std::size_t at = 0; at < waited.left_count; ++at) {
                std::printf(" left ");
                hex(waited.left[at].data, waited.left[at].size);
            }
            waited.left_count = 0;
            const bool has_more = count == 1 && recv(in, &first, 1, MSG_PEEK) >= 0;
            if (has_more) jausml_core_wait(core, 0.0, 1e300, &waited);
        } while (waited.left_count > 0);
        if (count > 1) {
            std::uint8_t buffer[65536];
            std::uint64_t told = 0;
            while (recv(in, buffer, sizeof buffer, 0) > 0) continue;
            if (eventfd_read(announced, &told) == 0) number_of_ros = 0;
        }
        std::printf("\n");
        std::fflush(stdout);
    }
    goes_on = false;
    other.join();
    jausml_core_stop(core);
    jausml_core_forget(core);
    jausml_core_end(core);
}
