// What the compiled translations of a bridge stand on: checks, and both serialized forms.
//
// A compiled translation does the usual case alone. Whatever is not usual (a value that is limited,
// a text beyond ASCII, bytes that are no message) makes a check fail, and the bridge then has the
// Python method treat the same bytes: it counts, drops and says what there is to say.
#pragma once

#include <string>
#include <utility>

#include "jaus.hpp"

// What the bridge finds by its name; all else stays inside of the library.
#define JAUSML_EXPORT extern "C" __attribute__((visibility("default")))

namespace jausml {

using Octets = std::vector<std::uint8_t>;

// Texts go into the other form as they are, where only ASCII means the same.
template <>
struct Characters<std::string> {
    static bool are_usual(const std::string& text) {
        return std::none_of(text.begin(), text.end(), [](char each) { return (each & 0x80) != 0; });
    }
};

// Tells whether the case is the usual one. A check that fails returns what may be computed with.
class Check : public Verdict {
public:
    // A real number within its limits.
    double limited(double value, double least, double greatest) {
        require(value >= least && value <= greatest);
        return value;
    }

    // The same, and nothing for what is no number: the bridge counts the field that is left out.
    std::optional<double> known(double value, double least, double greatest, unsigned field) {
        if (!std::isnan(value)) return limited(value, least, greatest);
        unknown_ |= std::uint64_t{1} << field;
        return std::nullopt;
    }

    // The fields that were left out, each a bit.
    std::uint64_t unknown() const { return unknown_; }

    // A number that a map limits on purpose; what is no number stays so.
    double within(double value, double least, double greatest) {
        require((value >= least && value <= greatest) || std::isnan(value));
        return value;
    }

    double finite(double value) {
        require(std::isfinite(value));
        return value;
    }

    double single(double value) {
        return limited(value, -3.4028234663852886e38, 3.4028234663852886e38);
    }

    // The nearest integer within its limits, the even one of two.
    std::int64_t integer(double value, std::int64_t least, std::int64_t greatest) {
        const double low = static_cast<double>(least), high = static_cast<double>(greatest);
        if (!(value > low - 0.5 && value < high + 0.5 && std::fabs(value) < 9.0e15)) {
            fail();
            return least;
        }
        return static_cast<std::int64_t>(std::nearbyint(value));
    }

    std::int64_t integer(std::int64_t value, std::int64_t least, std::int64_t greatest) {
        require(value >= least && value <= greatest);
        return value;
    }

    template <class Number>
    std::int64_t listed(Number value, Ranges<std::int64_t> ranges) {
        const std::int64_t found = integer(value, -(1LL << 53), 1LL << 53);
        require(is_within(found, ranges));
        return found;
    }

    template <class Sized>
    const Sized& sized(const Sized& value, std::size_t fewest, std::size_t most) {
        require(value.size() >= fewest && value.size() <= most);
        return value;
    }

    // Functions of expressions; one without a value is not usual.
    double valued(double value) { return finite(value); }
    double divide(double dividend, double divisor) {
        require(divisor != 0.0);
        return dividend / divisor;
    }

private:
    std::uint64_t unknown_ = 0;
};

// The integer that a real number is; 0 for one that is none, which a check has found before.
inline std::int64_t to_integer(double value) {
    return std::fabs(value) < 9.0e15 ? static_cast<std::int64_t>(value) : 0;
}

inline double least(double one, double other) {
    return std::isnan(one) || std::isnan(other) ? std::numeric_limits<double>::quiet_NaN()
           : other < one                        ? other
                                                : one;
}

inline double greatest(double one, double other) {
    return std::isnan(one) || std::isnan(other) ? std::numeric_limits<double>::quiet_NaN()
           : other > one                        ? other
                                                : one;
}

inline double sign(double value) {
    return value == 0.0 || std::isnan(value) ? value : std::copysign(1.0, value);
}

// Zero is added so that no result is a negative zero, which the integers of Python do not know.
inline double round_off(double value) { return std::nearbyint(value) + 0.0; }
inline double round_down(double value) { return std::floor(value) + 0.0; }
inline double round_up(double value) { return std::ceil(value) + 0.0; }

struct Quaternion {
    double x = 0.0, y = 0.0, z = 0.0, w = 0.0;
};

struct Time {
    std::int64_t sec = 0, nanosec = 0;
};

struct TimeStamp {
    std::int64_t milliseconds = 0, seconds = 0, minutes = 0, hour = 0, day = 0;
};

// Stores an orientation or an instant into a message of ROS.
template <class Message, class Value>
void set_quaternion(Message& target, const Value& value) {
    target.x = value.x;
    target.y = value.y;
    target.z = value.z;
    target.w = value.w;
}

template <class Message, class Value>
void set_time(Message& target, const Value& value) {
    target.sec = value.sec;
    target.nanosec = value.nanosec;
}

template <class Bits>
Bits stamped(const TimeStamp& value) {
    Bits made;
    made.milliseconds = value.milliseconds;
    made.seconds = value.seconds;
    made.minutes = value.minutes;
    made.hour = value.hour;
    made.day = value.day;
    return made;
}

template <class Key, class Value, std::size_t size>
Value look_up(Check& check, const std::pair<Key, Value> (&table)[size], const Key& key) {
    for (const auto& [known, value] : table) {
        if (known == key) return value;
    }
    check.fail();
    return Value{};
}

// Elements in the order of names, by the key of each; of equal keys the last one counts.
template <class Element>
std::vector<std::optional<Element>> by_name(const std::vector<std::string>& names,
                                            const std::vector<std::string>& keys,
                                            const std::vector<Element>& items) {
    std::vector<std::optional<Element>> found(names.size());
    for (std::size_t at = 0; at < std::min(keys.size(), items.size()); ++at) {
        for (std::size_t name = 0; name < names.size(); ++name) {
            if (names[name] == keys[at]) found[name] = items[at];
        }
    }
    return found;
}

// As many of the first elements of a list as are wanted and there.
template <class Element>
std::vector<Element> first_of(const std::vector<Element>& items, std::size_t count) {
    return {items.begin(), items.begin() + static_cast<std::ptrdiff_t>(std::min(count, items.size()))};
}

// Bytes that Python lends for the time of a call.
struct Bytes {
    const std::uint8_t* data;
    std::size_t size;

    std::string text() const { return std::string(reinterpret_cast<const char*>(data), size); }
};

// What a translation is given besides its message: what may change while the bridge runs.
struct Live {
    const double* quantities;
    const Bytes* texts;
    const Bytes* joins;
    std::int64_t sec;
    std::int64_t nanosec;

    Time now() const { return {sec, nanosec}; }
};

// An integer with the opposite sign; the least one has none.
inline std::int64_t opposite(Check& check, std::int64_t value) {
    check.require(value != std::numeric_limits<std::int64_t>::min());
    return static_cast<std::int64_t>(~static_cast<std::uint64_t>(value) + 1);
}

// A message of ROS in XCDR version 1 (OMG DDS-XTypes 1.3, 7.4), little endian.
class CdrInput : public Input {
public:
    using Input::Input;

    // Skips the encapsulation; positions count from behind it.
    bool begin() {
        check_.require(size_ >= 4 && data_[0] == 0 && data_[1] == 1);
        if (!check_.passed()) return false;
        data_ += 4;
        size_ -= 4;
        return true;
    }

    template <class Number>
    double real() {
        align(sizeof(Number));
        return static_cast<double>(this->template raw<Number>());
    }

    template <class Number>
    std::int64_t integer() {
        align(sizeof(Number));
        return this->template whole<Number>();
    }

    bool truth() { return this->template raw<std::uint8_t>() != 0; }

    std::string text() {
        const std::size_t count = static_cast<std::size_t>(integer<std::uint32_t>());
        if (count == 0) return {};
        std::string found;
        take(found, count);
        check_.require(!found.empty() && found.back() == '\0');
        if (!found.empty()) found.pop_back();
        return found;
    }

    // The count of a sequence, for whose elements there are bytes; 0 where there are not.
    std::size_t count(std::size_t least_size,
                      std::size_t most = std::numeric_limits<std::size_t>::max()) {
        const std::size_t found = static_cast<std::size_t>(integer<std::uint32_t>());
        if (found > most || found > left() / least_size) {
            check_.fail();
            return 0;
        }
        return found;
    }

    template <class Number, std::size_t size>
    std::array<Number, size> array() {
        std::array<Number, size> found{};
        align(sizeof(Number));
        copy(found.data(), size);
        return found;
    }

    template <class Number>
    std::vector<Number> sequence(std::size_t most = std::numeric_limits<std::size_t>::max()) {
        const std::size_t size = count(sizeof(Number), most);
        std::vector<Number> found(size);
        if (size != 0) {
            align(sizeof(Number));
            copy(found.data(), size);
        }
        return found;
    }

private:
    void align(std::size_t size) {
        const std::size_t padding = (size - at_ % size) % size;
        if (has(padding)) at_ += padding;
    }

    template <class Number>
    void copy(Number* into, std::size_t size) {
        if (!has(size * sizeof(Number))) return;
        std::memcpy(into, data_ + at_, size * sizeof(Number));
        at_ += size * sizeof(Number);
        if constexpr (std::is_same_v<Number, std::uint64_t>) {
            // What 63 bits do not hold is computed in Python.
            for (std::size_t item = 0; item < size; ++item) check_.require(into[item] >> 63 == 0);
        }
    }
};

class CdrOutput {
public:
    CdrOutput(Octets& out, Check& check) : check_(check), out_(out) {
        const std::uint8_t header[] = {0, 1, 0, 0};
        out_.assign(header, header + 4);
    }

    template <class Number>
    void real(double value) {
        const Number given = precise<Number>(check_, value);
        put(&given, 1);
    }

    template <class Number>
    void integer(std::int64_t value) {
        const Number given = static_cast<Number>(value);
        const bool is_negative = std::is_unsigned_v<Number> && value < 0;
        check_.require(static_cast<std::int64_t>(given) == value && !is_negative);
        put(&given, 1);
    }

    void truth(bool value) { out_.push_back(value ? 1 : 0); }

    void text(const std::string& value, std::size_t most = 0) {
        check_.require(most == 0 || value.size() <= most);
        integer<std::uint32_t>(static_cast<std::int64_t>(value.size()) + 1);
        out_.insert(out_.end(), value.begin(), value.end());
        out_.push_back(0);
    }

    void count(std::size_t value, std::size_t most = std::numeric_limits<std::size_t>::max()) {
        check_.require(value <= most);
        integer<std::uint32_t>(static_cast<std::int64_t>(value));
    }

    template <class Number, std::size_t size>
    void array(const std::array<Number, size>& value) {
        put(value.data(), size);
    }

    template <class Number>
    void sequence(const std::vector<Number>& value,
                  std::size_t most = std::numeric_limits<std::size_t>::max()) {
        count(value.size(), most);
        if (!value.empty()) put(value.data(), value.size());
    }

private:
    template <class Number>
    void put(const Number* values, std::size_t count) {
        const std::size_t at = out_.size() - 4;
        const std::size_t padding = (sizeof(Number) - at % sizeof(Number)) % sizeof(Number);
        out_.resize(out_.size() + padding);
        const auto* const begin = reinterpret_cast<const std::uint8_t*>(values);
        out_.insert(out_.end(), begin, begin + count * sizeof(Number));
    }

    Check& check_;
    Octets& out_;
};

// A number as an element of a list of ROS, which is no wider than its type.
template <class Number>
Number narrowed(Check& check, double value) {
    return precise<Number>(check, value);
}

template <class Number>
Number narrowed(Check& check, std::int64_t value) {
    const Number given = static_cast<Number>(value);
    check.require(static_cast<std::int64_t>(given) == value);
    return given;
}

// What a conversion makes of each octet, found once.
class OctetTable {
public:
    // The conversion is given a check and a number, and returns an integer.
    template <class Octet, class Convert>
    static OctetTable of(const Convert& convert) {
        OctetTable table;
        for (unsigned octet = 0; octet < 256; ++octet) {
            Check check;
            const auto given = static_cast<std::int64_t>(static_cast<Octet>(octet));
            const auto made = static_cast<std::uint8_t>(convert(check, given));
            table.made_[octet] = check.passed() ? made : ODD;
        }
        return table;
    }

    // Makes the elements of one list, an octet each, from those of another.
    template <class Items, class Target>
    void translate(Check& check, const Items& items, Target& into) const {
        static_assert(sizeof items[0] == 1 && sizeof into[0] == 1, "they lie as on the wire");
        const std::size_t size = items.size();
        into.resize(size);
        const auto* const from = reinterpret_cast<const std::uint8_t*>(items.data());
        auto* const to = reinterpret_cast<std::uint8_t*>(into.data());
        unsigned all = 0;
        for (std::size_t at = 0; at < size; ++at) {
            const std::uint16_t made = made_[from[at]];
            to[at] = static_cast<std::uint8_t>(made);
            all |= made;
        }
        check.require(all < ODD);
    }

private:
    static constexpr std::uint16_t ODD = 0x100;  // where the conversion is not usual
    std::array<std::uint16_t, 256> made_{};
};

// What a translation makes: bytes, and which fields were left out.
//
// The bytes stand where they are until the next call of the same thread.
struct Made {
    const std::uint8_t* data;
    std::uint64_t unknown;
};

// What a translation returns instead of a size where the case is not usual.
constexpr std::int64_t GIVES_WAY = -1;

// Reads a message, has another one made of it and writes that, from JAUS to ROS.
template <class Source, class Target, class Translate>
std::int64_t jaus_to_ros(const std::uint8_t* data, std::size_t size, Made* made,
                         const Translate& translate) {
    static thread_local Octets out;
    try {
        Check check;
        JausInput in(data, size, check);
        if (!in.begin(Source::CODE)) return GIVES_WAY;
        Source source;
        source.read(in);
        in.end();
        if (!check.passed()) return GIVES_WAY;
        Target target;
        translate(source, target, check);
        if (!check.passed()) return GIVES_WAY;
        CdrOutput output(out, check);
        target.write(output);
        *made = {out.data(), check.unknown()};
        return check.passed() ? static_cast<std::int64_t>(out.size()) : GIVES_WAY;
    } catch (...) {
        return GIVES_WAY;
    }
}

// The same from ROS to JAUS.
template <class Source, class Target, class Translate>
std::int64_t ros_to_jaus(const std::uint8_t* data, std::size_t size, Made* made,
                         const Translate& translate) {
    static thread_local Octets out(512);
    try {
        Check check;
        CdrInput in(data, size, check);
        if (!in.begin()) return GIVES_WAY;
        const Source source = Source::read(in);
        if (!check.passed()) return GIVES_WAY;
        Target target;
        translate(source, target, check);
        if (!check.passed()) return GIVES_WAY;
        for (;;) {
            const Outcome written = encode(target, out.data(), out.size());
            *made = {out.data(), check.unknown()};
            if (written) return static_cast<std::int64_t>(written.size);
            if (written.status != Status::no_room) return GIVES_WAY;
            out.resize(2 * out.size());
        }
    } catch (...) {
        return GIVES_WAY;
    }
}

// The latest message of a join; nothing where there is none that is fresh.
template <class Message>
std::optional<Message> joined_ros(const Bytes& bytes, Check& check) {
    if (bytes.data == nullptr) return std::nullopt;
    CdrInput in(bytes.data, bytes.size, check);
    if (!in.begin()) return std::nullopt;
    return Message::read(in);
}

template <class Message>
std::optional<Message> joined_jaus(const Bytes& bytes, Check& check) {
    if (bytes.data == nullptr) return std::nullopt;
    JausInput in(bytes.data, bytes.size, check);
    if (!in.begin(Message::CODE)) return std::nullopt;
    std::optional<Message> found;
    found.emplace().read(in);
    in.end();
    return found;
}

}  // namespace jausml
