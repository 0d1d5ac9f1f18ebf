// What JAUS messages as structs stand on: containers, and the serialized form (AS5684).
//
// It needs C++17, a little-endian processor and no exceptions. Decoding checks every count before
// it takes memory, and encoding every value. Lists and texts stand inside of their message where
// the model bounds them to JAUSML_INLINE_BYTES, and longer ones on the heap. With JAUSML_NO_HEAP
// there is no heap, and what is longer than JAUSML_INLINE_BYTES is refused as `no_room`.
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
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#ifndef JAUSML_INLINE_BYTES
#define JAUSML_INLINE_BYTES 1024
#endif

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "numbers are read as they lie");

namespace jausml {

// What is to be said of bytes or of a message; of several faults the first.
enum class Status : std::uint8_t {
    ok,
    other_code,       // it is another message
    ends_early,       // the bytes end within a field, or before what a count promises
    bytes_left_over,  // there are bytes behind the message
    unknown_bit,      // a bit of a presence vector stands for no field
    no_such_option,   // a tag or index chooses nothing
    count_not_legal,  // a list or text has more or fewer elements than the model allows
    not_legal,        // a number that model or type do not allow, or a text with a NUL
    no_room,          // the buffer, or a container without heap, is too small
    unusual,          // what the compiled translations of a bridge leave to others
};

// The status, and how many bytes were read or written before it was found.
struct Outcome {
    Status status;
    std::size_t size;

    explicit operator bool() const { return status == Status::ok; }
};

class Verdict {
public:
    void fail(Status why = Status::unusual, std::size_t at = 0) {
        if (passed()) found_ = {why, at};
    }
    void require(bool holds, Status why = Status::unusual, std::size_t at = 0) {
        if (!holds) fail(why, at);
    }
    bool passed() const { return found_.status == Status::ok; }
    Outcome outcome(std::size_t size) const {
        return passed() ? Outcome{Status::ok, size} : found_;
    }

private:
    Outcome found_{Status::ok, 0};
};

// -- containers -----------------------------------------------------------------------------------

// At most so many elements, without heap. More are cut off, and then the message is not encoded.
template <class T, std::size_t most>
class Bounded {
public:
    using value_type = T;

    static constexpr std::size_t max_size() { return most; }
    std::size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    bool is_cut() const { return is_cut_; }
    T* data() { return items_.data(); }
    const T* data() const { return items_.data(); }
    T* begin() { return data(); }
    const T* begin() const { return data(); }
    T* end() { return data() + size_; }
    const T* end() const { return data() + size_; }
    T& operator[](std::size_t at) { return items_[at]; }
    const T& operator[](std::size_t at) const { return items_[at]; }

    void clear() { resize(0); }
    void push_back(const T& item) {
        resize(size_ + 1);
        if (!is_cut_) items_[size_ - 1] = item;
    }
    void resize(std::size_t size) {
        is_cut_ = size > most;
        const std::size_t kept = std::min(size, most);
        for (std::size_t at = size_; at < kept; ++at) items_[at] = T{};
        size_ = kept;
    }
    template <class Iterator>
    void assign(Iterator from, Iterator to) {
        resize(static_cast<std::size_t>(to - from));
        std::copy_n(from, size_, items_.begin());
    }

private:
    std::array<T, most> items_{};
    std::size_t size_ = 0;
    bool is_cut_ = false;
};

template <class T, std::size_t most, std::size_t fitting = JAUSML_INLINE_BYTES / sizeof(T)>
#ifdef JAUSML_NO_HEAP
using List = Bounded<T, std::min(most, std::max(fitting, std::size_t{1}))>;
#else
using List = std::conditional_t<(most <= fitting), Bounded<T, most>, std::vector<T>>;
#endif

// Characters of Latin-1.
template <std::size_t most>
struct Text : List<char, most> {
    Text() = default;
    Text(std::string_view text) { this->assign(text.begin(), text.end()); }
    std::string_view view() const { return {this->data(), this->size()}; }
};

template <class T, std::size_t size>
std::array<T, size> filled(const T& value) {
    std::array<T, size> made{};
    made.fill(value);
    return made;
}

template <class Any>
auto is_cut(const Any& value, int) -> decltype(value.is_cut()) {
    return value.is_cut();
}

template <class Any>
bool is_cut(const Any&, long) {
    return false;
}

// Gives an array its elements; that of a fixed size has them.
template <class T>
void fit(std::vector<T>& array, std::size_t size) {
    array.resize(size);
}

template <class T, std::size_t size>
void fit(std::array<T, size>&, std::size_t) {}

// Whether a kind of text can be told as it is.
template <class Any>
struct Characters {
    static bool are_usual(const Any&) { return true; }
};

// -- numbers --------------------------------------------------------------------------------------

// Integers are compared in 64 bits, with a sign except where there is no room for one.
template <class Value>
using Wide =
    std::conditional_t<std::is_same_v<Value, std::uint64_t>, std::uint64_t, std::int64_t>;

template <class Value>
using Ranges = std::initializer_list<std::pair<Value, Value>>;

template <class Value>
bool is_within(Value value, Ranges<Wide<Value>> ranges) {
    const auto wide = static_cast<Wide<Value>>(value);
    for (const auto& [low, high] : ranges) {
        if (wide >= low && wide <= high) return true;
    }
    return false;
}

// A sum of which nothing is expected where it has no place in 64 bits.
inline std::int64_t shifted(std::int64_t value, std::int64_t offset) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(value) +
                                     static_cast<std::uint64_t>(offset));
}

// From here on a real number may have been another integer before it was rounded.
constexpr std::int64_t EXACT = 1LL << 53;

// A real number in the precision of its type. What is beyond that, though rounding might spare it,
// is refused.
template <class Number>
Number precise(Verdict& verdict, double value) {
    constexpr double most = static_cast<double>(std::numeric_limits<Number>::max());
    if (std::isfinite(value) && std::fabs(value) > most) {
        verdict.fail();
        return 0;
    }
    return static_cast<Number>(value);
}

// Part of a step by which floating point may miss an integer that was decoded before.
constexpr double SLACK = 1e-3;

// -- bytes ----------------------------------------------------------------------------------------

// Bytes of a message from front to back; where they end too early, zeros are read.
class Input {
public:
    Input(const std::uint8_t* data, std::size_t size, Verdict& check)
        : check_(check), data_(data), size_(size) {}

    std::size_t left() const { return size_ - at_; }
    void fail(Status why) { check_.fail(why, at_); }
    void require(bool holds, Status why) { check_.require(holds, why, at_); }

protected:
    bool has(std::size_t count) {
        if (count <= left()) return true;
        fail(Status::ends_early);
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

    template <class Sized>
    void take(Sized& into, std::size_t count) {
        if (!has(count)) return;
        if (count > into.max_size()) return fail(Status::no_room);
        const auto* const begin = reinterpret_cast<const typename Sized::value_type*>(data_ + at_);
        into.assign(begin, begin + count);
        require(Characters<Sized>::are_usual(into), Status::unusual);
        at_ += count;
    }

    template <class Number>
    std::int64_t whole() {
        const Number value = raw<Number>();
        if constexpr (sizeof(Number) == 8 && std::is_unsigned_v<Number>) {
            constexpr auto most = static_cast<Number>(std::numeric_limits<std::int64_t>::max());
            require(value <= most, Status::not_legal);
        }
        return static_cast<std::int64_t>(value);
    }

    Verdict& check_;
    const std::uint8_t* data_;
    std::size_t size_;
    std::size_t at_ = 0;
};

// A JAUS message (AS5684): packed, little endian.
class JausInput : public Input {
public:
    using Input::Input;

    bool begin(std::uint16_t code) {
        require(raw<std::uint16_t>() == code, Status::other_code);
        return check_.passed();
    }

    void end() { require(left() == 0, Status::bytes_left_over); }

    template <class Number, class Value>
    void integer(Value& into, std::int64_t offset = 0) {
        if constexpr (std::is_same_v<Value, std::uint64_t>) {
            into = static_cast<Value>(raw<Number>()) + static_cast<Value>(offset);
        } else {
            const std::int64_t found = shifted(whole<Number>(), offset);
            if constexpr (std::is_floating_point_v<Value>) {
                require(found > -EXACT && found < EXACT, Status::not_legal);
            }
            into = static_cast<Value>(found);
        }
    }

    template <class Number, class Value>
    void real(Value& into) {
        into = raw<Number>();
    }

    template <class Number>
    void scaled(double& into, double lower, double step) {
        into = static_cast<double>(raw<Number>()) * step + lower;
    }

    template <class Number>
    std::uint64_t bits() {
        return raw<Number>();
    }

    template <class Number>
    std::uint64_t presence(std::uint64_t known) {
        const std::uint64_t found = raw<Number>();
        require((found & ~known) == 0, Status::unknown_bit);
        return found;
    }

    template <class Text>
    void padded(Text& into, std::size_t length) {
        if (!has(length)) return;
        const std::size_t behind = at_ + length;
        const auto* const begin = data_ + at_;
        take(into, static_cast<std::size_t>(std::find(begin, begin + length, 0) - begin));
        at_ = behind;
    }

    // Makes room for the elements of a list if there are bytes for them.
    template <class Number, class Sized>
    void sized(Sized& into, std::uint64_t most, std::size_t least_size) {
        const std::size_t found = count<Number>(most, least_size);
        if (found > into.max_size()) return fail(Status::no_room);
        into.resize(found);
    }

    // Bytes or characters.
    template <class Number, class Sized>
    void counted(Sized& into, std::uint64_t most) {
        take(into, count<Number>(most, 1));
    }

    // The elements of a list that are an octet each, and have a place.
    template <class Sized>
    void octets(Sized& into) {
        static_assert(sizeof(typename Sized::value_type) == 1, "they lie as on the wire");
        if (!has(into.size()) || into.empty()) return;
        std::memcpy(into.data(), data_ + at_, into.size());
        at_ += into.size();
    }

private:
    template <class Number>
    std::size_t count(std::uint64_t most, std::size_t least_size) {
        const std::uint64_t found = raw<Number>();
        require(found <= most, Status::count_not_legal);
        require(found <= left() / least_size, Status::ends_early);
        return check_.passed() ? static_cast<std::size_t>(found) : 0;
    }
};

class JausOutput {
public:
    JausOutput(std::uint8_t* data, std::size_t capacity, Verdict& check)
        : check_(check), data_(data), capacity_(capacity) {}

    std::size_t size() const { return size_; }
    void fail(Status why) { check_.fail(why, size_); }
    void require(bool holds, Status why = Status::not_legal) { check_.require(holds, why, size_); }

    template <class Number>
    void raw(Number value) {
        put(&value, sizeof value);
    }

    template <class Number, class Value>
    void integer(Value value, Ranges<Wide<Value>> ranges, std::int64_t offset = 0) {
        require(is_within(value, ranges));
        raw(static_cast<Number>(shifted(static_cast<std::int64_t>(value), -offset)));
    }

    // The integer that a real number is.
    template <class Number>
    void whole(double value, Ranges<Wide<Number>> ranges, std::int64_t offset = 0) {
        constexpr double most = static_cast<double>(EXACT);
        constexpr double low = std::is_same_v<Number, std::uint64_t> ? 0.0 : 1.0 - most;
        const bool is_whole = value >= low && value < most && std::nearbyint(value) == value;
        require(is_whole);
        integer<Number>(is_whole ? static_cast<Wide<Number>>(value) : 0, ranges, offset);
    }

    template <class Number>
    void real(double value, double lower, double upper) {
        require(value >= lower && value <= upper);
        raw(precise<Number>(check_, value));
    }

    template <class Number>
    void scaled(double value, double lower, double step) {
        raw(bounded<Number>(std::nearbyint(placed<Number>(value, lower, step))));
    }

    template <class Number>
    void scaled_down(double value, double lower, double step) {
        raw(bounded<Number>(std::floor(placed<Number>(value, lower, step) + SLACK)));
    }

    template <class Number>
    void scaled_up(double value, double lower, double step) {
        raw(bounded<Number>(std::ceil(placed<Number>(value, lower, step) - SLACK)));
    }

    template <class Text>
    void padded(const Text& value, std::size_t length) {
        require(value.size() <= length && !is_cut(value, 0), Status::count_not_legal);
        require(std::find(value.begin(), value.end(), '\0') == value.end());
        put_all(value);
        for (std::size_t at = value.size(); at < length; ++at) raw(std::uint8_t{0});
    }

    template <class Number, class Sized>
    void count(const Sized& value, std::uint64_t fewest, std::uint64_t most) {
        const bool fits = value.size() >= fewest && value.size() <= most && !is_cut(value, 0);
        require(fits, Status::count_not_legal);
        raw(static_cast<Number>(value.size()));
    }

    template <class Number, class Sized>
    void counted(const Sized& value, std::uint64_t fewest, std::uint64_t most) {
        count<Number>(value, fewest, most);
        put_all(value);
    }

    // The elements of a list that are an octet each.
    template <class Octet, class Sized>
    void octets(const Sized& items, Ranges<std::int64_t> ranges) {
        static_assert(sizeof(typename Sized::value_type) == 1, "they lie as on the wire");
        const auto* const begin = reinterpret_cast<const Octet*>(items.data());
        using Limits = std::numeric_limits<Octet>;
        for (const auto& [low, high] : ranges) {
            if (low <= Limits::min() && high >= Limits::max()) {
                return put(items.data(), items.size());
            }
        }
        bool are_legal = true;
        for (std::size_t at = 0; at < items.size(); ++at) are_legal &= is_within(begin[at], ranges);
        require(are_legal);
        put(items.data(), items.size());
    }

    // Writes over what was put where bytes begin, as a presence vector when all fields are known.
    template <class Number>
    void over(std::size_t at, std::uint64_t value) {
        const Number given = static_cast<Number>(value);
        if (size_ - at >= sizeof given) std::memcpy(data_ + at, &given, sizeof given);
    }

private:
    void put(const void* bytes, std::size_t count) {
        if (count > capacity_ - size_) return fail(Status::no_room);
        if (count != 0) std::memcpy(data_ + size_, bytes, count);
        size_ += count;
    }

    template <class Sized>
    void put_all(const Sized& value) {
        require(Characters<Sized>::are_usual(value), Status::unusual);
        put(value.data(), value.size());
    }

    // The position of a value between the ends of its scale, which it may miss by a trifle.
    template <class Number>
    double placed(double value, double lower, double step) {
        constexpr double maximum = static_cast<double>(std::numeric_limits<Number>::max());
        const double position = (value - lower) / step;
        const double slack = SLACK + maximum * 0x1p-50;
        require(position >= -slack && position <= maximum + slack);
        return position;
    }

    template <class Number>
    Number bounded(double position) {
        constexpr double maximum = static_cast<double>(std::numeric_limits<Number>::max());
        if (!(position > 0.0)) return 0;
        return position < maximum ? static_cast<Number>(position)
                                  : std::numeric_limits<Number>::max();
    }

    Verdict& check_;
    std::uint8_t* data_;
    std::size_t capacity_;
    std::size_t size_ = 0;
};

// -- messages -------------------------------------------------------------------------------------

// Reads a payload: message code and body. What is refused leaves a message half read.
template <class Message>
Outcome decode(const std::uint8_t* data, std::size_t size, Message& into) {
    Verdict verdict;
    JausInput in(data, size, verdict);
    into = Message();
    if (in.begin(Message::CODE)) {
        into.read(in);
        in.end();
    }
    return verdict.outcome(size);
}

// Writes a payload into a buffer; the outcome has its size.
template <class Message>
Outcome encode(const Message& message, std::uint8_t* data, std::size_t capacity) {
    Verdict verdict;
    JausOutput out(data, capacity, verdict);
    out.raw(Message::CODE);
    message.write(out);
    return verdict.outcome(out.size());
}

// Gives a visitor the message that a payload holds: the first of several that fits.
template <class Message, class... Others, class Visitor>
Outcome visit(const std::uint8_t* data, std::size_t size, Visitor&& visitor) {
    Message message;
    const Outcome outcome = decode(data, size, message);
    if (outcome) visitor(message);
    if constexpr (sizeof...(Others) > 0) {
        if (!outcome) return visit<Others...>(data, size, visitor);
    }
    return outcome;
}

}  // namespace jausml
