// Decodes the payloads of a file of lines `Message payload`, and encodes them again.
#include <cctype>
#include <cerrno>
#include <cfenv>
#include <cfloat>
#include <climits>
#include <clocale>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <cwchar>
#include <fstream>
#include <iostream>
#include <string>

#include "messages.hpp"

namespace {

// Memory of its own for each message, so that a sanitizer sees the byte behind.
using Bytes = std::vector<std::uint8_t>;

std::string hex(const Bytes& bytes) {
    std::string text;
    for (const auto each : bytes) {
        text += "0123456789abcdef"[each >> 4];
        text += "0123456789abcdef"[each & 15];
    }
    return text;
}

Bytes bytes_of(const std::string& text) {
    Bytes bytes;
    for (std::size_t at = 0; at + 1 < text.size(); at += 2) {
        bytes.push_back(static_cast<std::uint8_t>(std::stoi(text.substr(at, 2), nullptr, 16)));
    }
    return bytes;
}

// One for all messages: to clear a megabyte for each takes longer than to encode it.
Bytes room(1 << 20);

template <class Message>
void encode(const Message& message) {
    const auto whole = jausml::encode(message, room.data(), room.size());
    std::cout << "encoded " << static_cast<int>(whole.status);
    if (whole) {
        const Bytes made(room.begin(), room.begin() + static_cast<std::ptrdiff_t>(whole.size));
        std::cout << ' ' << hex(made);
        for (std::size_t size = 0; size < made.size(); ++size) {
            Bytes little(size);
            const auto none = jausml::encode(message, little.data(), size);
            if (none.status != jausml::Status::no_room) std::abort();
        }
    }
    std::cout << '\n';
}

struct Visitor {
    bool is_visited = false;

    template <class Message>
    void operator()(const Message&) {
        is_visited = true;
    }
};

template <class Message>
void turn(const Bytes& bytes) {
    Message message;
    const auto found = jausml::decode(bytes.data(), bytes.size(), message);
    if (found) {
        encode(message);
        Visitor visitor;
        const auto visited = jaus::visit(bytes.data(), bytes.size(), visitor);
        if (!visited || !visitor.is_visited) std::abort();
    } else {
        std::cout << "decoded " << static_cast<int>(found.status) << '\n';
    }
}

template <class Message, class Set>
void given(const Set& set) {
    Message message;
    set(message);
    encode(message);
}

#include "vectors.inc"

}  // namespace

int main(int, char** arguments) {
    make_given();
    std::ifstream file(arguments[1]);
    for (std::string line; std::getline(file, line);) {
        const auto blank = line.find(' ');
        turn_named(line.substr(0, blank), bytes_of(line.substr(blank + 1)));
    }
}
