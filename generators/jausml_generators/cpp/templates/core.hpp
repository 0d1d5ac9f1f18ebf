// What the compiled translations of a bridge stand on: checks, and both serialized forms.
//
// A compiled translation does the usual case alone. Whatever is not usual (a value that is limited,
// a text beyond ASCII, bytes that are no message) makes a check fail, and the bridge then has the
// Python method treat the same bytes: it counts, drops and says what there is to say.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "both forms are read as they lie");

// What the bridge finds by its name; all else stays inside of the library.
#define JAUSML_EXPORT extern "C" __attribute__((visibility("default")))

namespace jausml {

using Octets = std::vector<std::uint8_t>;
using Ranges = std::initializer_list<std::pair<std::int64_t, std::int64_t>>;

// Tells whether the case is the usual one. A check that fails returns what may be computed with.
class Check {
public:
    void fail() { passed_ = false; }
    bool passed() const { return passed_; }
    void require(bool holds) { passed_ = passed_ && holds; }

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
    std::int64_t listed(Number value, Ranges ranges) {
        const std::int64_t found = integer(value, -(1LL << 53), 1LL << 53);
        require(is_within(found, ranges));
        return found;
    }

    template <class Sized>
    const Sized& sized(const Sized& value, std::size_t fewest, std::size_t most) {
        require(value.size() >= fewest && value.size() <= most);
        return value;
    }

    static bool is_within(std::int64_t value, Ranges ranges) {
        for (const auto& [low, high] : ranges) {
            if (value >= low && value <= high) return true;
        }
        return false;
    }

    // Functions of expressions; one without a value is not usual.
    double valued(double value) { return finite(value); }
    double divide(double dividend, double divisor) {
        require(divisor != 0.0);
        return dividend / divisor;
    }

private:
    bool passed_ = true;
    std::uint64_t unknown_ = 0;
};

// A real number in the precision of its type. What is beyond that, though rounding might spare it,
// is not usual.
template <class Number>
Number precise(Check& check, double value) {
    constexpr double most = static_cast<double>(std::numeric_limits<Number>::max());
    if (std::isfinite(value) && std::fabs(value) > most) {
        check.fail();
        return 0;
    }
    return static_cast<Number>(value);
}

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

// A sum of which nothing is expected where it has no place in 64 bits.
inline std::int64_t shifted(std::int64_t value, std::int64_t offset) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(value) +
                                     static_cast<std::uint64_t>(offset));
}

// An integer with the opposite sign; the least one has none.
inline std::int64_t opposite(Check& check, std::int64_t value) {
    check.require(value != std::numeric_limits<std::int64_t>::min());
    return static_cast<std::int64_t>(~static_cast<std::uint64_t>(value) + 1);
}

// Bytes of a message from front to back; where they end too early, zeros are read.
class Input {
public:
    Input(const std::uint8_t* data, std::size_t size, Check& check)
        : check_(check), data_(data), size_(size) {}

    std::size_t left() const { return size_ - at_; }

protected:
    bool has(std::size_t count) {
        if (count <= left()) return true;
        check_.fail();
        at_ = size_;
        return false;
    }

    template <class Number>
    Number raw() {
        Number value{};
        if (!has(sizeof value)) return value;
        std::memcpy(&value, data_ + at_, sizeof value);
        at_ += sizeof value;
        return value;
    }

    // Characters of ASCII, which mean the same in both forms.
    std::string ascii(std::size_t count) {
        if (!has(count)) return {};
        const char* const begin = reinterpret_cast<const char*>(data_ + at_);
        at_ += count;
        std::string found(begin, count);
        for (const char each : found) check_.require((each & 0x80) == 0);
        return found;
    }

    template <class Number>
    std::int64_t whole() {
        const Number value = raw<Number>();
        if constexpr (sizeof(Number) == 8 && std::is_unsigned_v<Number>) {
            check_.require(value <= static_cast<Number>(std::numeric_limits<std::int64_t>::max()));
        }
        return static_cast<std::int64_t>(value);
    }

    Check& check_;
    const std::uint8_t* data_;
    std::size_t size_;
    std::size_t at_ = 0;
};

// A JAUS message (AS5684): packed, little endian.
class JausInput : public Input {
public:
    using Input::Input;

    bool begin(std::uint16_t code) {
        check_.require(raw<std::uint16_t>() == code);
        return check_.passed();
    }

    void end() { check_.require(left() == 0); }

    template <class Number>
    std::int64_t integer(std::int64_t offset = 0) {
        return shifted(this->template whole<Number>(), offset);
    }

    template <class Number>
    double real() {
        return static_cast<double>(this->template raw<Number>());
    }

    template <class Number>
    double scaled(double lower, double step) {
        return static_cast<double>(this->template raw<Number>()) * step + lower;
    }

    template <class Number>
    std::uint64_t bits() {
        return this->template raw<Number>();
    }

    template <class Number>
    std::uint64_t presence(std::uint64_t known) {
        const std::uint64_t found = this->template raw<Number>();
        check_.require((found & ~known) == 0);
        return found;
    }

    std::string padded(std::size_t length) {
        if (!has(length)) return {};
        const void* const end = std::memchr(data_ + at_, 0, length);
        const std::size_t behind = at_ + length;
        const std::size_t count =
            end == nullptr ? length : static_cast<const std::uint8_t*>(end) - (data_ + at_);
        std::string found = ascii(count);
        at_ = behind;
        return found;
    }

    // The count of a list, for whose elements there are bytes; 0 where there are not.
    template <class Number>
    std::size_t count(std::uint64_t most, std::size_t least_size) {
        const std::uint64_t found = this->template raw<Number>();
        if (found > most || found > left() / least_size) {
            check_.fail();
            return 0;
        }
        return static_cast<std::size_t>(found);
    }

    template <class Number>
    std::string text(std::uint64_t most) {
        return ascii(this->template count<Number>(most, 1));
    }

    template <class Number>
    Octets octets(std::uint64_t most) {
        const std::size_t found = this->template count<Number>(most, 1);
        const std::uint8_t* const begin = data_ + at_;
        at_ += found;
        return Octets(begin, begin + found);
    }

    void fail() { check_.fail(); }
};

// Part of a step by which floating point may miss an integer that was decoded before.
constexpr double SLACK = 1e-3;

class JausOutput {
public:
    JausOutput(Octets& out, Check& check) : check_(check), out_(out) {}

    template <class Number>
    void raw(Number value) {
        const auto* const begin = reinterpret_cast<const std::uint8_t*>(&value);
        out_.insert(out_.end(), begin, begin + sizeof value);
    }

    template <class Number>
    void integer(std::int64_t value, std::int64_t lower, std::int64_t upper,
                 std::int64_t offset = 0) {
        check_.require(value >= lower && value <= upper);
        raw(static_cast<Number>(shifted(value, -offset)));
    }

    template <class Number>
    void one_of(std::int64_t value, Ranges ranges, std::int64_t offset = 0) {
        check_.require(Check::is_within(value, ranges));
        raw(static_cast<Number>(shifted(value, -offset)));
    }

    template <class Number>
    void whole(double value, Ranges ranges) {
        integer_of<Number>(value, ranges);
    }

    template <class Number>
    void real(double value, double lower, double upper) {
        check_.require(value >= lower && value <= upper);
        raw(precise<Number>(check_, value));
    }

    template <class Number>
    void scaled(double value, double lower, double step) {
        const double position = placed<Number>(value, lower, step);
        raw(bounded<Number>(std::nearbyint(position)));
    }

    template <class Number>
    void scaled_down(double value, double lower, double step) {
        const double position = placed<Number>(value, lower, step);
        raw(bounded<Number>(std::floor(position + SLACK)));
    }

    template <class Number>
    void scaled_up(double value, double lower, double step) {
        const double position = placed<Number>(value, lower, step);
        raw(bounded<Number>(std::ceil(position - SLACK)));
    }

    void padded(const std::string& value, std::size_t length) {
        check_.require(value.size() <= length && value.find('\0') == std::string::npos);
        put(value);
        out_.resize(out_.size() + length - std::min(length, value.size()));
    }

    template <class Number, class Sized>
    void count(const Sized& value, std::uint64_t fewest, std::uint64_t most) {
        check_.require(value.size() >= fewest && value.size() <= most);
        raw(static_cast<Number>(value.size()));
    }

    template <class Number>
    void text(const std::string& value, std::uint64_t fewest, std::uint64_t most) {
        this->template count<Number>(value, fewest, most);
        put(value);
    }

    template <class Number>
    void octets(const Octets& value, std::uint64_t fewest, std::uint64_t most) {
        this->template count<Number>(value, fewest, most);
        out_.insert(out_.end(), value.begin(), value.end());
    }

    std::size_t size() const { return out_.size(); }

    // Writes over what was put where bytes begin, as a presence vector when all fields are known.
    template <class Number>
    void over(std::size_t at, std::uint64_t value) {
        const Number given = static_cast<Number>(value);
        std::memcpy(out_.data() + at, &given, sizeof given);
    }

    void require(bool holds) { check_.require(holds); }
    void fail() { check_.fail(); }

private:
    void put(const std::string& value) {
        for (const char each : value) check_.require((each & 0x80) == 0);
        out_.insert(out_.end(), value.begin(), value.end());
    }

    // The position of a value between the ends of its scale, which it may miss by a trifle.
    template <class Number>
    double placed(double value, double lower, double step) {
        constexpr double maximum = static_cast<double>(std::numeric_limits<Number>::max());
        const double position = (value - lower) / step;
        const double slack = SLACK + maximum * 0x1p-50;
        check_.require(position >= -slack && position <= maximum + slack);
        return position;
    }

    template <class Number>
    Number bounded(double position) {
        constexpr double maximum = static_cast<double>(std::numeric_limits<Number>::max());
        if (!(position > 0.0)) return 0;
        return position < maximum ? static_cast<Number>(position)
                                  : std::numeric_limits<Number>::max();
    }

    template <class Number>
    void integer_of(double value, Ranges ranges) {
        const bool is_whole = std::fabs(value) < 0x1p53 && std::nearbyint(value) == value;
        check_.require(is_whole);
        const std::int64_t found = is_whole ? static_cast<std::int64_t>(value) : 0;
        check_.require(Check::is_within(found, ranges));
        raw(static_cast<Number>(found));
    }

    Check& check_;
    Octets& out_;
};

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
        std::string found = ascii(count);
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
        const Source source = Source::read(in);
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
    static thread_local Octets out;
    try {
        Check check;
        CdrInput in(data, size, check);
        if (!in.begin()) return GIVES_WAY;
        const Source source = Source::read(in);
        if (!check.passed()) return GIVES_WAY;
        Target target;
        translate(source, target, check);
        if (!check.passed()) return GIVES_WAY;
        out.clear();
        JausOutput output(out, check);
        output.raw(Target::CODE);
        target.write(output);
        *made = {out.data(), check.unknown()};
        return check.passed() ? static_cast<std::int64_t>(out.size()) : GIVES_WAY;
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
    std::optional<Message> found = Message::read(in);
    in.end();
    return found;
}

}  // namespace jausml
