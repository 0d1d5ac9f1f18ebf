// The usual way of messages between a socket and ROS, while the loop of the bridge waits for others.
//
// Python finds out what the usual messages are, and lends what they need: routes by header and code,
// the places of peers, the publishers and subscriptions of rclpy. Whatever is not usual is handed
// back with the bytes that were read, and Python takes it as if it had read them itself. What was
// done is told for each message, and Python writes it down where it would have done so, before
// anything else of its own runs.
//
// The loop waits here without the lock of the interpreter. All other calls are made by the thread of
// the loop while it does not wait, but for `stop`: after it nothing passes here until Python says so.
#pragma once

#include <netinet/in.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <ctime>
#include <memory>
#include <mutex>
#include <new>
#include <unordered_map>

#include "core.hpp"

namespace jausml {

using Translate = std::int64_t (*)(const std::uint8_t*, std::size_t, const Live*, Made*);

// What the client library of ROS has, whose headers may not be there.
struct Allocator {
    void* (*allocate)(std::size_t, void*);
    void (*deallocate)(void*, void*);
    void* (*reallocate)(void*, std::size_t, void*);
    void* (*zero_allocate)(std::size_t, std::size_t, void*);
    void* state;
};

struct Serialized {
    std::uint8_t* data;
    std::size_t size;
    std::size_t capacity;
    Allocator allocator;
};

struct MessageInfo {
    std::int64_t published;
    std::int64_t received;
    std::uint64_t number;
    std::uint64_t reception_number;
    std::uint8_t rest[64];
};

struct Ros {
    int (*publish)(const void*, const Serialized*, void*);
    int (*take)(const void*, Serialized*, MessageInfo*, void*);
    void (*forget_error)();
    Allocator (*allocator)();
};

// A translation with what may change between two messages.
struct Translation {
    Translate translate;
    Live* live;
    std::uint8_t needs_clock;

    std::int64_t run(const std::uint8_t* data, std::size_t size, Made& made) const {
        if (needs_clock != 0) {
            timespec now{};
            clock_gettime(CLOCK_REALTIME, &now);
            live->sec = now.tv_sec;
            live->nanosec = now.tv_nsec;
        }
        return translate(data, size, live, &made);
    }
};

inline std::int64_t realtime() {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    return static_cast<std::int64_t>(now.tv_sec) * 1000000000 + now.tv_nsec;
}

// The time by which Python's loop turns, which goes on while the computer is suspended.
inline double steady() {
    timespec now{};
    clock_gettime(CLOCK_BOOTTIME, &now);
    return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

inline std::uint32_t little(const std::uint8_t* data, std::size_t size) {
    std::uint32_t found = 0;
    for (std::size_t at = size; at-- > 0;) found = found << 8 | data[at];
    return found;
}

inline void put_little(std::uint8_t* data, std::uint32_t value, std::size_t size) {
    for (std::size_t at = 0; at < size; ++at) data[at] = static_cast<std::uint8_t>(value >> 8 * at);
}

// A datagram of JUDP (AS5669A): version, type, size, flags, destination, source; then the payload
// and the sequence number.
constexpr std::size_t HEADER = 13;
constexpr std::size_t NUMBER = 2;
constexpr std::size_t EMPTY = HEADER - 1 + NUMBER;
constexpr std::size_t CODE = 2;
constexpr std::uint32_t VERSION = 2;
constexpr std::uint32_t EVENT = 0x41F1;
constexpr std::size_t EVENT_HEADER = 8;
constexpr std::size_t LARGEST = 65536;
constexpr std::size_t OVERHEAD = 400;  // of a packet of a message that is not whole
constexpr std::uint8_t FIRST_PACKET = 1 << 6, MIDDLE_PACKET = 2 << 6, LAST_PACKET = 3 << 6;

inline void put_header(std::uint8_t* data, std::size_t size, std::uint8_t flags,
                       std::uint32_t destination, std::uint32_t source) {
    put_little(data, VERSION, 2);
    put_little(data + 2, static_cast<std::uint32_t>(EMPTY + size), 2);
    data[4] = flags;
    put_little(data + 5, destination, 4);
    put_little(data + 9, source, 4);
}

// The sequence numbers that came lately, of which those that Python remembers are some.
class Window {
public:
    bool has(std::uint16_t number) const { return (bits_[number >> 6] >> (number & 63) & 1) != 0; }

    void add(std::uint16_t number) {
        if (has(number)) return;
        if (count_ >= KEPT) {
            const std::uint16_t oldest = order_[count_ % KEPT];
            bits_[oldest >> 6] &= ~(std::uint64_t{1} << (oldest & 63));
        }
        order_[count_++ % KEPT] = number;
        bits_[number >> 6] |= std::uint64_t{1} << (number & 63);
    }

private:
    static constexpr std::size_t KEPT = 1024;
    std::array<std::uint64_t, 1024> bits_{};
    std::array<std::uint16_t, KEPT> order_{};
    std::size_t count_ = 0;
};

// What is known of the messages of one kind from one component; Python reads and writes it too.
struct Order {
    double latest_at;
    std::uint16_t latest;
    std::uint8_t has_latest;
    std::uint8_t expected;
};

// Which messages are usual, and what is done with them.
struct Route {
    std::uint32_t source;
    std::uint32_t destination;
    std::uint32_t host;
    std::uint32_t code;
    std::uint16_t port;
    std::uint8_t flags;
    std::uint8_t answer;
    std::uint8_t is_event;
    std::uint8_t event;
    std::uint8_t is_ordered;
    std::uint32_t index;
    const void* publisher;
    const Translation* translation;
    Order order;
};

// A message that was taken, in one packet or several, whose last one has the number.
struct Taken {
    double at;
    std::uint64_t unknown;
    const std::uint8_t* data;
    std::size_t size;
    const std::uint32_t* sizes;
    std::size_t packets;
    std::uint32_t index;
    std::uint16_t number;
    std::uint8_t was_answered;
};

// A datagram that is left to Python.
struct Datagram {
    const std::uint8_t* data;
    std::size_t size;
    std::uint32_t host;
    std::uint32_t port;
};

// A message that was sent, of the subscription with an index.
struct Sent {
    double at;
    std::int64_t published;
    std::uint64_t unknown;
    std::uint32_t index;
    std::uint32_t datagrams;
    std::int32_t error;
};

// Messages that are passed on before Python writes them down.
constexpr std::size_t AT_ONCE = 32;

// What was done, and what is left to Python: descriptors, and datagrams that were received.
struct Waited {
    Taken taken[AT_ONCE];
    Sent sent[AT_ONCE];
    std::int32_t ready[AT_ONCE];
    std::size_t taken_count;
    std::size_t sent_count;
    std::size_t ready_count;
    const Datagram* left;
    std::size_t left_count;
};

// Why no more messages were taken.
enum class Left { NOTHING, ENOUGH, OTHER };

// Receives from a socket.
class Receiver {
public:
    explicit Receiver(const Ros& ros) : ros_(ros), allocator_(ros.allocator()) {}

    void forget() {
        routes_.clear();
        windows_.clear();
    }

    // Takes messages of several packets up to so many bytes.
    void limit(std::size_t most) { most_ = most; }

    // Begins anew: what was told before is written down.
    void begin() {
        whole_.clear();
        left_.clear();
        given_back_.clear();
    }

    // Leaves to Python the packets of a message that is not whole.
    void give_back() {
        if (!assembly_) return;
        const Assembly& held = *assembly_;
        std::size_t at = 0;
        for (std::size_t number = 0; number < held.sizes.size(); ++number) {
            const std::size_t size = held.sizes[number];
            Octets made(HEADER + size + NUMBER);
            const std::uint8_t place = number == 0 ? FIRST_PACKET : MIDDLE_PACKET;
            put_header(made.data(), size, held.flags | place, held.destination, held.source);
            std::memcpy(made.data() + HEADER, held.payload.data() + at, size);
            put_little(made.data() + HEADER + size, held.first + static_cast<std::uint32_t>(number),
                       NUMBER);
            given_back_.push_back(std::move(made));
            left_.push_back({given_back_.back().data(), given_back_.back().size(), held.host,
                             held.port});
            at += size;
        }
        assembly_.reset();
    }

    const std::vector<Datagram>& left() const { return left_; }

    // Adds a route; returns what Python shares of it.
    Order* add(const Route& route, const std::uint16_t* numbers, std::size_t count) {
        auto& window = windows_[pair(route.source, route.destination)];
        if (!window) {
            window = std::make_unique<Window>();
            for (std::size_t at = 0; at < count; ++at) window->add(numbers[at]);
        }
        auto& known = routes_[key(route)];
        known = std::make_unique<Route>(route);
        return &known->order;
    }

    // Reads what has come, at most what is wanted at once, until something is not usual.
    //
    // To find that nothing more has come costs more than a datagram, after a pause. So more than one
    // is looked for only when one follows the other.
    Left receive(int sock, Waited& out) {
        now_ = steady();
        if (now_ - latest_ > PAUSE) burst_ = 1;
        latest_ = now_;
        const auto goes_on = [&](std::size_t done) {
            return (done < burst_ || assembly_) && done < MOST && out.taken_count < AT_ONCE;
        };
        for (std::size_t done = 0; goes_on(done); ++done) {
            sockaddr_in origin{};
            socklen_t length = sizeof origin;
            std::uint8_t* const into = buffers_[out.taken_count].data();
            const ssize_t got = recvfrom(sock, into, LARGEST, 0,
                                         reinterpret_cast<sockaddr*>(&origin), &length);
            if (got < 0) {
                burst_ = 1;
                return errno == EAGAIN || errno == EWOULDBLOCK ? Left::NOTHING : Left::OTHER;
            }
            if (!take(into, static_cast<std::size_t>(got), origin, sock, out)) {
                give_back();
                left_.push_back({into, static_cast<std::size_t>(got),
                                 ntohl(origin.sin_addr.s_addr), ntohs(origin.sin_port)});
                return Left::OTHER;
            }
        }
        burst_ = std::min(2 * burst_, AT_ONCE);
        return Left::ENOUGH;
    }

private:
    static constexpr double PAUSE = 0.0002;
    static constexpr std::size_t MOST = 64;
    static constexpr double LATEST = 2.0;
    static constexpr std::uint16_t FARTHEST = 1024;

    static std::uint64_t pair(std::uint32_t source, std::uint32_t destination) {
        return std::uint64_t{source} << 32 | destination;
    }

    // Components have 32 bits and so has what a message is: a mixture of both finds the route.
    static std::uint64_t key(const Route& route) {
        return key(route.source, route.destination, route.flags,
                   route.is_event != 0 ? EVENT : route.code, route.event);
    }

    static std::uint64_t key(std::uint32_t source, std::uint32_t destination, std::uint32_t flags,
                             std::uint32_t code, std::uint32_t event) {
        const std::uint64_t what = flags << 24 | code << 8 | event;
        return pair(source, destination) * 0x9E3779B97F4A7C15u ^ what;
    }

    // A message of several packets, of which those that came are in order.
    struct Assembly {
        std::uint32_t source;
        std::uint32_t destination;
        std::uint32_t host;
        std::uint32_t port;
        std::uint8_t flags;
        std::uint16_t first;
        Route* route;
        Octets payload;
        std::vector<std::uint32_t> sizes;
    };

    bool take(const std::uint8_t* const in, std::size_t length, const sockaddr_in& origin,
              int answering, Waited& out) {
        if (length < HEADER + CODE + NUMBER || little(in + 2, 2) != length - 1 ||
            little(in, 2) != VERSION)
            return false;
        const std::uint32_t destination = little(in + 5, 4), source = little(in + 9, 4);
        const auto window = windows_.find(pair(source, destination));
        if (window == windows_.end()) return false;
        const auto number = static_cast<std::uint16_t>(little(in + length - NUMBER, NUMBER));
        if (window->second->has(number)) return false;
        window->second->add(number);
        const std::uint8_t* const payload = in + HEADER;
        const std::size_t size = length - HEADER - NUMBER;
        const std::uint8_t place = in[4] & LAST_PACKET;
        if (place == MIDDLE_PACKET || place == LAST_PACKET)
            return add(in, payload, size, number, origin, out);
        const std::uint32_t code = little(payload, CODE);
        const std::uint32_t event = code == EVENT && size > CODE ? payload[CODE] : 0;
        const std::uint8_t flags = in[4] & ~LAST_PACKET;
        const auto found = routes_.find(key(source, destination, flags, code, event));
        if (found == routes_.end()) return false;
        Route& route = *found->second;
        if (route.source != source || route.destination != destination || route.flags != flags ||
            route.host != ntohl(origin.sin_addr.s_addr) || route.port != ntohs(origin.sin_port))
            return false;
        if (place == FIRST_PACKET) {
            if (assembly_ || route.answer != 0) return false;
            assembly_ = std::make_unique<Assembly>(
                Assembly{source, destination, route.host, route.port, flags, number, &route,
                         Octets(payload, payload + size), {static_cast<std::uint32_t>(size)}});
            return true;
        }
        if (assembly_) return false;  // what began before it is Python's, and so is this
        return pass(route, payload, size, number, origin, answering, out);
    }

    // Adds a packet to what is not whole.
    bool add(const std::uint8_t* in, const std::uint8_t* payload, std::size_t size,
             std::uint16_t number, const sockaddr_in& origin, Waited& out) {
        if (!assembly_) return false;
        Assembly& held = *assembly_;
        const auto following = static_cast<std::uint16_t>(held.first + held.sizes.size());
        if (held.source != little(in + 9, 4) || held.destination != little(in + 5, 4) ||
            held.flags != (in[4] & ~LAST_PACKET) || number != following ||
            held.host != ntohl(origin.sin_addr.s_addr) || held.port != ntohs(origin.sin_port) ||
            held.payload.size() + size + (held.sizes.size() + 1) * OVERHEAD > most_)
            return false;
        if ((in[4] & LAST_PACKET) != LAST_PACKET) {
            held.payload.insert(held.payload.end(), payload, payload + size);
            held.sizes.push_back(static_cast<std::uint32_t>(size));
            return true;
        }
        Octets message(held.payload);
        message.insert(message.end(), payload, payload + size);
        if (!pass(*held.route, message.data(), message.size(), number, origin, -1, out))
            return false;
        held.sizes.push_back(static_cast<std::uint32_t>(size));
        held.payload = std::move(message);
        whole_.push_back(std::move(assembly_));
        Taken& taken = out.taken[out.taken_count - 1];
        taken.data = whole_.back()->payload.data();
        taken.sizes = whole_.back()->sizes.data();
        taken.packets = whole_.back()->sizes.size();
        return true;
    }

    bool pass(Route& route, const std::uint8_t* payload, std::size_t size, std::uint16_t number,
              const sockaddr_in& origin, int answering, Waited& out) {
        const std::size_t before = route.is_event != 0 ? EVENT_HEADER : 0;
        if (route.is_event != 0 &&
            (size < EVENT_HEADER + CODE || payload[3] != route.order.expected ||
             little(payload + 4, 4) != size - EVENT_HEADER))
            return false;
        if (little(payload + before, CODE) != route.code || !is_newest(route, number)) return false;
        std::uint64_t unknown = 0;
        if (!publish(route, payload + before, size - before, unknown)) return false;
        const bool is_answered = route.answer != 0;
        if (is_answered) answer(route, number, origin, answering);
        out.taken[out.taken_count++] = {now_, unknown,     payload, size, nullptr,
                                        1,    route.index, number,  static_cast<std::uint8_t>(is_answered)};
        return true;
    }

    // Whether a command is newer than what came before it of the same source.
    bool is_newest(Route& route, std::uint16_t number) const {
        if (route.is_ordered == 0) return true;
        Order& order = route.order;
        const auto behind = static_cast<std::uint16_t>(order.latest - number);
        if (order.has_latest != 0 && behind > 0 && behind <= FARTHEST &&
            now_ - order.latest_at < LATEST)
            return false;
        order.latest = number;
        order.latest_at = now_;
        order.has_latest = 1;
        return true;
    }

    bool publish(Route& route, const std::uint8_t* message, std::size_t size,
                 std::uint64_t& unknown) {
        Made made{nullptr, 0};
        const std::int64_t made_size = route.translation->run(message, size, made);
        if (made_size < 0) return false;
        // Nobody writes to what is published, though the type would allow it.
        const auto out = static_cast<std::size_t>(made_size);
        const Serialized serialized{const_cast<std::uint8_t*>(made.data), out, out, allocator_};
        if (ros_.publish(route.publisher, &serialized, nullptr) != 0) {
            ros_.forget_error();
            return false;
        }
        if (route.is_event != 0) ++route.order.expected;
        unknown = made.unknown;
        return true;
    }

    static void answer(const Route& route, std::uint16_t number, const sockaddr_in& origin,
                       int answering) {
        std::uint8_t out[HEADER + NUMBER];
        put_header(out, 0, route.answer, route.source, route.destination);
        put_little(out + HEADER, number, NUMBER);
        sendto(answering, out, sizeof out, 0, reinterpret_cast<const sockaddr*>(&origin),
               sizeof origin);
    }

    Ros ros_;
    Allocator allocator_;
    std::unordered_map<std::uint64_t, std::unique_ptr<Window>> windows_;
    std::unordered_map<std::uint64_t, std::unique_ptr<Route>> routes_;
    std::array<std::array<std::uint8_t, LARGEST>, AT_ONCE> buffers_;
    std::unique_ptr<Assembly> assembly_;
    std::vector<std::unique_ptr<Assembly>> whole_;
    std::vector<Octets> given_back_;
    std::vector<Datagram> left_;
    std::size_t most_ = 0;
    std::size_t burst_ = 1;
    double latest_ = 0.0;
    double now_ = 0.0;
};

// Where the messages of a subscription go, as one datagram or several.
struct Destination {
    std::uint32_t host;
    std::uint16_t port;
    std::uint8_t flags;
    std::int32_t sock;
    std::uint32_t destination;
    std::uint32_t source;
    std::size_t longest;
    double lifetime;
    double heard;
    std::atomic<std::uint64_t>* numbers;
};

// A subscription, as Python tells of it; the numbers of what is expected and lost go on here.
struct Subscription {
    const void* handle;
    const Translation* translation;
    const Destination* to;
    std::int32_t descriptor;
    std::uint32_t index;
    std::int64_t age_limit;
    std::uint64_t expected;
    std::uint64_t lost;
};

// The message of a subscription that is not usual, and how many more wait.
struct Pending {
    const std::uint8_t* data;
    std::size_t size;
    std::int64_t published;
    std::int64_t received;
    std::uint64_t number;
    std::uint64_t left;
};

// Tells whether packets of one message can go to a component in one go, as Python's `Bursts` does.
class Bursts {
public:
    bool fit(std::size_t count, double now) {
        const double level = std::max(0.0, level_ - (now - since_) * PER_SECOND);
        if (level + static_cast<double>(count) > MOST) return false;
        level_ = level + static_cast<double>(count);
        since_ = now;
        return true;
    }

private:
    static constexpr double MOST = 10.0, PER_SECOND = 8000.0;
    double level_ = 0.0, since_ = 0.0;
};

// Takes the messages of a subscription.
class Subscriber {
public:
    Subscriber(const Ros& ros, Subscription* shared, Bursts& bursts)
        : ros_(ros), shared_(shared), bursts_(bursts), message_{nullptr, 0, 0, ros.allocator()} {}
    Subscriber(const Subscriber&) = delete;
    Subscriber& operator=(const Subscriber&) = delete;
    ~Subscriber() {
        if (message_.data != nullptr)
            message_.allocator.deallocate(message_.data, message_.allocator.state);
    }

    // Takes the messages that were announced, until one is not usual.
    Left take(Waited& out) {
        std::uint64_t left = 0;
        if (read(shared_->descriptor, &left, sizeof left) != sizeof left) return Left::NOTHING;
        const std::int64_t oldest = shared_->age_limit > 0 ? realtime() - shared_->age_limit : 0;
        for (; left > 0 && out.sent_count < AT_ONCE; --left) {
            MessageInfo info{};
            if (ros_.take(shared_->handle, &message_, &info, nullptr) != 0) {
                ros_.forget_error();
                shared_->lost += left;  // what was announced and is not there was overwritten
                return Left::NOTHING;
            }
            const bool is_old = info.received > 0 && info.received < oldest;
            if (info.number != shared_->expected || is_old || !pass(info, out)) {
                pending = {message_.data, message_.size, info.published,
                           info.received, info.number, left - 1};
                return Left::OTHER;
            }
            ++shared_->expected;
        }
        return again(left);
    }

    // Has so many messages be announced once more.
    Left again(std::uint64_t left) const {
        const bool is_told = left == 0 || write(shared_->descriptor, &left, sizeof left) > 0;
        return is_told ? Left::ENOUGH : Left::NOTHING;
    }

    Pending pending{};

private:
    static constexpr std::size_t MOST_PARTS = 40;
    static constexpr std::size_t LARGEST_PART = 4079;

    bool pass(const MessageInfo& info, Waited& out) {
        const double now = steady();
        if (now - shared_->to->heard >= shared_->to->lifetime) return false;
        Made made{nullptr, 0};
        const std::int64_t size = shared_->translation->run(message_.data, message_.size, made);
        if (size < static_cast<std::int64_t>(CODE)) return false;
        const auto bytes = static_cast<std::size_t>(size);
        if (bytes > shared_->to->longest && !bursts_.fit((bytes - 1) / step_of(bytes) + 1, now))
            return false;  // it is to be acknowledged
        Sent& done = out.sent[out.sent_count++];
        done = {now, info.published, made.unknown, shared_->index, 0, 0};
        send_all(made.data, bytes, done);
        return true;
    }

    std::size_t step_of(std::size_t size) const {
        const std::size_t needed = (size + MOST_PARTS - 1) / MOST_PARTS;
        return std::max(shared_->to->longest, std::min(LARGEST_PART, needed));
    }

    void send_all(const std::uint8_t* data, std::size_t size, Sent& done) const {
        if (size <= shared_->to->longest) {
            send_part(data, size, shared_->to->flags, done);
            return;
        }
        const std::size_t step = step_of(size);
        for (std::size_t at = 0; at < size && done.error == 0; at += step) {
            const bool is_last = at + step >= size;
            const std::uint8_t place = at == 0 ? FIRST_PACKET : is_last ? LAST_PACKET : MIDDLE_PACKET;
            send_part(data + at, std::min(step, size - at), shared_->to->flags | place, done);
        }
    }

    void send_part(const std::uint8_t* data, std::size_t size, std::uint8_t flags, Sent& done) const {
        std::uint8_t header[HEADER], number[NUMBER];
        put_header(header, size, flags, shared_->to->destination, shared_->to->source);
        put_little(number, static_cast<std::uint32_t>(shared_->to->numbers->fetch_add(1, std::memory_order_relaxed)), NUMBER);
        iovec parts[] = {{header, HEADER},
                         {const_cast<std::uint8_t*>(data), size},
                         {number, NUMBER}};
        sockaddr_in target{};
        target.sin_family = AF_INET;
        target.sin_addr.s_addr = htonl(shared_->to->host);
        target.sin_port = htons(shared_->to->port);
        msghdr message_out{};
        message_out.msg_name = &target;
        message_out.msg_namelen = sizeof target;
        message_out.msg_iov = parts;
        message_out.msg_iovlen = 3;
        if (sendmsg(shared_->to->sock, &message_out, 0) < 0)
            done.error = errno;
        else
            ++done.datagrams;
    }

    Ros ros_;
    Subscription* shared_;
    Bursts& bursts_;
    Serialized message_;
};

// Waits as the loop of a bridge does, and has usual messages pass meanwhile.
class Core {
public:
    Core(const Ros& ros, int epoll) : receiver(ros), ros_(ros), epoll_(epoll) {}

    // Lets nothing pass from now on; returns when nothing does.
    void stop() {
        const std::lock_guard<std::mutex> guard(passing_);
        is_open_ = false;
    }

    void start() {
        const std::lock_guard<std::mutex> guard(passing_);
        is_open_ = true;
    }

    void forget() {
        receiver.forget();
        subscribers_.clear();
        if (bursts_.size() >= MOST_DESTINATIONS) bursts_.clear();
    }

    void listen(int sock, std::size_t most) {
        sock_ = sock;
        receiver.limit(most);
    }

    Pending* subscribe(Subscription* shared) {
        auto& found = subscribers_[shared->descriptor];
        Bursts& bursts = bursts_[shared->to->destination];
        found = std::make_unique<Subscriber>(ros_, shared, bursts);
        return &found->pending;
    }

    // Waits for at most so many seconds, below 0 for ever; until something is left to Python.
    //
    // due: When the process must have stood still, by the steady clock: what waits then is old.
    //
    // Returns the descriptor that is ready, if all else is nothing; then nobody reads more memory.
    std::int32_t wait(double seconds, double due, Waited& out) {
        out.taken_count = out.sent_count = out.ready_count = 0;
        receiver.begin();
        const double end = seconds < 0 ? 1e300 : steady() + seconds;
        for (bool goes_on = true; goes_on;) {
            epoll_event events[AT_ONCE];
            const std::size_t passed = out.taken_count + out.sent_count;
            const bool has_many = passed >= MANY;
            if (has_many) pause(end);
            const int most = has_many ? 0 : milliseconds(end, passed != 0);
            const int found = epoll_wait(epoll_, events, AT_ONCE, most);
            const double now = steady();
            goes_on = found > 0 && now < end;
            const std::lock_guard<std::mutex> guard(passing_);
            const bool is_open = is_open_ && now <= due;
            for (int at = 0; at < found; ++at) {
                const int descriptor = events[at].data.fd;
                const Left left = is_open && events[at].events == EPOLLIN ? pass(descriptor, out)
                                                                          : Left::OTHER;
                if (left == Left::OTHER) out.ready[out.ready_count++] = descriptor;
            }
            goes_on = goes_on && out.ready_count == 0 && out.taken_count < AT_ONCE &&
                      out.sent_count < AT_ONCE;
        }
        receiver.give_back();  // what is not whole when Python goes on is Python's
        out.left = receiver.left().data();
        out.left_count = receiver.left().size();
        if (out.taken_count + out.sent_count + out.left_count != 0 || out.ready_count > 1)
            return SEVERAL;
        return out.ready_count == 1 ? out.ready[0] : NONE;
    }

    static constexpr std::int32_t NONE = -1;
    static constexpr std::int32_t SEVERAL = -2;

    Receiver receiver;

private:
    static constexpr std::size_t MOST_DESTINATIONS = 256;

    // Python writes down what has passed when it is quiet, and not before what comes next. The more
    // there is to write the shorter a quiet will do, in which the next message would have to wait;
    // and whom the last one woke may need this processor first.
    static constexpr int QUIET = 3;
    static constexpr std::size_t MANY = 8;
    static constexpr double SHORT_QUIET = 0.00025;

    // Waits until something comes, for a short quiet; epoll knows milliseconds alone.
    void pause(double end) const {
        const double left = std::max(std::min(end - steady(), SHORT_QUIET), 0.0);
        const timespec most{0, static_cast<long>(left * 1e9)};
        pollfd waiting{epoll_, POLLIN, 0};
        ppoll(&waiting, 1, &most, nullptr);
    }

    static int milliseconds(double end, bool has_passed) {
        if (end >= 1e300) return has_passed ? QUIET : -1;
        const double left = std::ceil((end - steady()) * 1e3);
        return left <= 0 ? 0 : static_cast<int>(std::min(left, has_passed ? QUIET : 1e9));
    }

    Left pass(int descriptor, Waited& out) {
        if (descriptor == sock_) return receiver.receive(descriptor, out);
        const auto found = subscribers_.find(descriptor);
        return found == subscribers_.end() ? Left::OTHER : found->second->take(out);
    }

    Ros ros_;
    int epoll_;
    int sock_ = -1;
    std::unordered_map<int, std::unique_ptr<Subscriber>> subscribers_;
    std::unordered_map<std::uint32_t, Bursts> bursts_;
    std::mutex passing_;
    bool is_open_ = false;
};

}  // namespace jausml

// What Python calls. Pointers that it gives stay its own, and outlive what is made here.

JAUSML_EXPORT jausml::Core* jausml_core(const jausml::Ros* ros, int epoll) {
    return new (std::nothrow) jausml::Core(*ros, epoll);
}

JAUSML_EXPORT void jausml_core_end(const jausml::Core* core) { delete core; }

JAUSML_EXPORT void jausml_core_stop(jausml::Core* core) { core->stop(); }

JAUSML_EXPORT void jausml_core_start(jausml::Core* core) { core->start(); }

JAUSML_EXPORT void jausml_core_forget(jausml::Core* core) { core->forget(); }

JAUSML_EXPORT void jausml_core_listen(jausml::Core* core, int sock, std::size_t most) {
    core->listen(sock, most);
}

JAUSML_EXPORT jausml::Order* jausml_core_add(jausml::Core* core, const jausml::Route* route,
                                             const std::uint16_t* numbers, std::size_t count) {
    try {
        return core->receiver.add(*route, numbers, count);
    } catch (...) {
        return nullptr;
    }
}

JAUSML_EXPORT jausml::Pending* jausml_core_subscribe(jausml::Core* core,
                                                     jausml::Subscription* shared) {
    try {
        return core->subscribe(shared);
    } catch (...) {
        return nullptr;
    }
}

JAUSML_EXPORT std::int32_t jausml_core_wait(jausml::Core* core, double seconds, double due,
                                            jausml::Waited* out) {
    try {
        return core->wait(seconds, due, *out);
    } catch (...) {
        out->left_count = 0;  // there is no memory for what waits
        return jausml::Core::SEVERAL;
    }
}

JAUSML_EXPORT std::uint64_t jausml_next_number(std::atomic<std::uint64_t>* numbers) {
    return numbers->fetch_add(1, std::memory_order_relaxed);
}
