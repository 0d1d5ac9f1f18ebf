// The loops of the floor without Python between the two sockets; see floor.py.
//
// What is called of the client library of ROS is declared here, as its headers may not be there.
#include <netinet/in.h>
#include <sys/socket.h>

#include <cstddef>
#include <cstdint>

namespace {

struct Allocator {
    void* (*allocate)(std::size_t, void*);
    void (*deallocate)(void*, void*);
    void* (*reallocate)(void*, std::size_t, void*);
    void* (*zero_allocate)(std::size_t, std::size_t, void*);
    void* state;
};

struct Serialized {
    std::uint8_t* buffer;
    std::size_t size;
    std::size_t capacity;
    Allocator allocator;
};

constexpr std::size_t kFlags = 4;
constexpr std::size_t kNumber = 2;

}  // namespace

extern "C" {

Allocator rcutils_get_default_allocator();
int rcl_publish_serialized_message(const void* publisher, const Serialized*, void*);
int rcl_take_serialized_message(const void* subscription, Serialized*, void*, void*);
int rcl_wait_set_clear(void* wait_set);
int rcl_wait_set_add_subscription(void* wait_set, const void* subscription, std::size_t*);
int rcl_wait(void* wait_set, std::int64_t nanoseconds);

// Publishes for each message that comes in, of one datagram or several.
int relay_up(int sock, const void* publisher, std::uint8_t* out, std::size_t size) {
    static std::uint8_t data[65536];
    const Serialized message{out, size, size, rcutils_get_default_allocator()};
    while (recv(sock, data, sizeof data, 0) > 0) {
        const int place = data[kFlags] >> 6;
        if (place != 1 && place != 2 && rcl_publish_serialized_message(publisher, &message, nullptr))
            return 1;
    }
    return 2;
}

// Sends a message for each one that is published: its datagrams, with room for their numbers.
int relay_down(int sock, int port, void* wait_set, const void* subscription, std::uint8_t** parts,
               const std::size_t* sizes, std::size_t count) {
    sockaddr_in target{};
    target.sin_family = AF_INET;
    target.sin_port = htons(static_cast<std::uint16_t>(port));
    target.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    Serialized taken{nullptr, 0, 0, rcutils_get_default_allocator()};
    std::uint16_t number = 0;
    while (!rcl_wait_set_clear(wait_set) &&
           !rcl_wait_set_add_subscription(wait_set, subscription, nullptr) &&
           !rcl_wait(wait_set, -1)) {
        if (rcl_take_serialized_message(subscription, &taken, nullptr, nullptr)) continue;
        for (std::size_t at = 0; at < count; ++at) {
            ++number;
            parts[at][sizes[at] - kNumber] = static_cast<std::uint8_t>(number);
            parts[at][sizes[at] - 1] = static_cast<std::uint8_t>(number >> 8);
            sendto(sock, parts[at], sizes[at], 0, reinterpret_cast<const sockaddr*>(&target),
                   sizeof target);
        }
    }
    return 1;
}

}  // extern "C"
