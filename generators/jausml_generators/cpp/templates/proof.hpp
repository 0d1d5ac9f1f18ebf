// A program that puts the values of numbers through compiled translations, there and back.
//
// Values are counted by their position in their own order, so that neighbours are neighbours and
// what does not keep the order is seen. Nothing here computes what a translation does: it puts bits
// into a message, calls the functions of the bridge, and compares.
#pragma once

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <thread>

#include "core.hpp"

namespace jausml::proof {

using Translate = std::int64_t (*)(const std::uint8_t*, std::size_t, const Live*, Made*);

enum Kind : std::uint64_t { unsigned_number, signed_number, real_number };

// A number in the bytes of a message; with a turn, values that differ by it are one angle.
struct Number {
    std::uint64_t at, size, bits, shift, kind;
    double lower, step, turn;

    std::uint64_t mask() const { return bits == 64 ? ~std::uint64_t{0} : (1ULL << bits) - 1; }
    std::uint64_t sign() const { return 1ULL << (bits - 1); }

    // The bits of the value at a position in the order of values.
    std::uint64_t raw(std::uint64_t index) const {
        if (kind == unsigned_number) return index;
        if (kind == signed_number || (index & sign()) != 0) return index ^ sign();
        return ~index & mask();
    }

    double value(std::uint64_t raw) const {
        if (kind == real_number) return size == 4 ? as<float>(raw) : as<double>(raw);
        if (kind == unsigned_number) return static_cast<double>(raw) * step + lower;
        const std::uint64_t extended = (raw & sign()) != 0 ? raw | ~mask() : raw;
        return static_cast<double>(static_cast<std::int64_t>(extended)) * step + lower;
    }

    std::uint64_t read(const std::uint8_t* data) const {
        std::uint64_t whole = 0;
        std::memcpy(&whole, data + at, size);
        return (whole >> shift) & mask();
    }
    void put(std::uint8_t* data, std::uint64_t raw) const {
        std::uint64_t whole = 0;
        std::memcpy(&whole, data + at, size);
        whole = (whole & ~(mask() << shift)) | (raw << shift);
        std::memcpy(data + at, &whole, size);
    }

    // How far two values are apart; infinite where one of them is no number and the other is one.
    double distance(std::uint64_t one, std::uint64_t other) const {
        const double first = value(one), second = value(other);
        if (first == second || (std::isnan(first) && std::isnan(second))) return 0.0;
        const double found = std::fabs(first - second);
        if (std::isnan(found)) return std::numeric_limits<double>::infinity();
        return turn > 0.0 ? std::min(found, std::fabs(turn - found)) : found;
    }

private:
    template <class Real>
    static double as(std::uint64_t raw) {
        Real found;
        std::memcpy(&found, &raw, sizeof found);
        return static_cast<double>(found);
    }
};

// A translation, and the values of the bridge that it is given.
struct Way {
    Translate translate = nullptr;
    const Live* live = nullptr;
    std::size_t joins = 0;
};

// A translation of messages to which others are joined. These stand at the end of some bytes that
// stay where they are, with their sizes behind them.
class Joined {
public:
    Joined(const Way& way, const std::uint8_t* data, std::size_t size)
        : translate_(way.translate), size_(size - way.joins * sizeof(std::uint32_t)) {
        if (way.live != nullptr) live_ = *way.live;
        const std::uint8_t* const sizes = data + size_;
        joins_.resize(way.joins);
        for (std::size_t at = way.joins; at-- > 0;) {
            std::uint32_t taken = 0;
            std::memcpy(&taken, sizes + at * sizeof taken, sizeof taken);
            size_ -= taken;
            joins_[at] = {data + size_, taken};
        }
        live_.joins = joins_.data();
    }
    Joined(const Joined&) = delete;
    Joined& operator=(const Joined&) = delete;

    // Bytes of the message that the others are joined to.
    std::size_t size() const { return size_; }
    const Live* live() const { return &live_; }

    std::int64_t translate(const std::uint8_t* data, std::size_t size, Made* made) const {
        return translate_(data, size, &live_, made);
    }

private:
    Translate translate_;
    std::size_t size_;
    Live live_{};
    std::vector<Bytes> joins_;
};

struct Sweep {
    Way there, back;
    std::vector<std::uint8_t> message;     // with what is joined to it
    std::vector<std::uint8_t> joins_back;  // what is joined to the message between both ways
    std::uint64_t between;  // size of the message between both ways
    Number number;
    std::vector<Number> watched;  // numbers of the message between
    std::vector<Number> varied;   // numbers that are random meanwhile
    std::uint64_t first, count;
    std::vector<std::uint64_t> listed;

    std::uint64_t index(std::uint64_t at) const { return listed.empty() ? first + at : listed[at]; }
};

// How a value goes with the order of what is swept.
struct Course {
    double first = 0.0, last = 0.0, least = 0.0, greatest = 0.0;
    std::uint64_t seen = 0, rises = 0, falls = 0;

    void see(double value) {
        if (!std::isnan(value)) follow({value, value, value, value, 1, 0, 0});
    }
    void follow(const Course& next) {
        if (next.seen == 0) return;
        if (seen == 0) {
            *this = next;
            return;
        }
        rises += next.rises + (next.first > last ? 1 : 0);
        falls += next.falls + (next.first < last ? 1 : 0);
        least = std::min(least, next.least);
        greatest = std::max(greatest, next.greatest);
        seen += next.seen;
        last = next.last;
    }
};

constexpr std::size_t BINS = 256;

// What became of values; of those that are left to Python, positions that lie far apart.
struct Tally {
    std::uint64_t count = 0, unchanged = 0, changed = 0, left_out = 0, others = 0, drifting = 0;
    std::uint64_t left = 0, stride = 1;
    double largest = 0.0, largest_drift = 0.0;
    std::uint64_t largest_at = 0, largest_back = 0, drift_at = 0;
    Course result;
    std::vector<Course> watched;
    std::vector<std::uint64_t> examples;
    std::array<double, BINS> bins{};

    void leave(std::uint64_t index, std::size_t most) {
        if (left++ % stride != 0) return;
        examples.push_back(index);
        if (examples.size() <= most) return;
        stride *= 2;
        for (std::size_t at = 0; 2 * at < examples.size(); ++at) examples[at] = examples[2 * at];
        examples.resize((examples.size() + 1) / 2);
    }

    void note_error(const Number& number, std::uint64_t index, std::uint64_t raw,
                    std::uint64_t back) {
        ++changed;
        const double error = number.distance(raw, back);
        double& bin = bins[number.bits > 8 ? index >> (number.bits - 8) : index];
        bin = std::max(bin, error);
        if (error <= largest) return;
        largest = error;
        largest_at = index;
        largest_back = back;
    }

    // What was rounded once should stay as it is in a second trip.
    void note_drift(const Number& number, std::uint64_t index, std::uint64_t back,
                    std::uint64_t again) {
        const double drift = number.distance(back, again);
        drifting += drift != 0.0 ? 1 : 0;
        if (drift <= largest_drift) return;
        largest_drift = drift;
        drift_at = index;
    }

    void follow(const Tally& next, std::size_t most) {
        count += next.count;
        unchanged += next.unchanged;
        changed += next.changed;
        left_out += next.left_out;
        others += next.others;
        drifting += next.drifting;
        if (next.largest > largest) {
            largest = next.largest;
            largest_at = next.largest_at;
            largest_back = next.largest_back;
        }
        if (next.largest_drift > largest_drift) {
            largest_drift = next.largest_drift;
            drift_at = next.drift_at;
        }
        result.follow(next.result);
        watched.resize(next.watched.size());
        for (std::size_t at = 0; at < watched.size(); ++at) watched[at].follow(next.watched[at]);
        const std::uint64_t before = left;
        for (const std::uint64_t index : next.examples) leave(index, most);
        left = before + next.left;
        for (std::size_t at = 0; at < BINS; ++at) bins[at] = std::max(bins[at], next.bins[at]);
    }
};

// A random number that belongs to another one (SplitMix64).
inline std::uint64_t scattered(std::uint64_t from) {
    std::uint64_t found = from * 0x9E3779B97F4A7C15ULL + 0x9E3779B97F4A7C15ULL;
    found = (found ^ (found >> 30)) * 0xBF58476D1CE4E5B9ULL;
    found = (found ^ (found >> 27)) * 0x94D049BB133111EBULL;
    return found ^ (found >> 31);
}

// Takes one value around in its message; false where the compiled form leaves it to Python.
inline bool around(const Sweep& sweep, const Joined& there, const Joined& back_way,
                   std::uint8_t* message, std::uint64_t index, Tally& tally) {
    const Number& number = sweep.number;
    const std::size_t whole = there.size();
    const std::uint64_t raw = number.raw(index);
    number.put(message, raw);
    for (std::size_t at = 0; at < sweep.varied.size(); ++at) {
        const Number& each = sweep.varied[at];
        each.put(message, scattered(index + (std::uint64_t{at} << 40)) & each.mask());
    }
    Made made{};
    std::int64_t size = there.translate(message, whole, &made);
    if (size < 0) return false;
    if (static_cast<std::uint64_t>(size) == sweep.between) {
        for (std::size_t at = 0; at < sweep.watched.size(); ++at) {
            const Number& each = sweep.watched[at];
            tally.watched[at].see(each.value(each.read(made.data)));
        }
    }
    if (sweep.back.translate == nullptr) {
        ++tally.unchanged;
        return true;
    }
    size = back_way.translate(made.data, static_cast<std::size_t>(size), &made);
    if (size < 0) return false;
    if (static_cast<std::size_t>(size) != whole) {
        ++tally.left_out;
        return true;
    }
    const std::uint64_t back = number.read(made.data);
    tally.result.see(number.value(back));
    // What else has changed is seen with the number as it was.
    std::uint8_t* const returned = const_cast<std::uint8_t*>(made.data);
    number.put(returned, raw);
    tally.others += std::memcmp(message, returned, whole) != 0 ? 1 : 0;
    if (number.distance(raw, back) == 0.0) {
        ++tally.unchanged;
        return true;
    }
    tally.note_error(number, index, raw, back);
    number.put(returned, back);
    size = there.translate(returned, whole, &made);
    if (size < 0) return true;
    size = back_way.translate(made.data, static_cast<std::size_t>(size), &made);
    if (static_cast<std::size_t>(size) != whole) return true;
    tally.note_drift(number, index, back, number.read(made.data));
    return true;
}

inline void in_messages(const Sweep& sweep, std::uint64_t from, std::uint64_t to, std::size_t most,
                        Tally& tally) {
    std::vector<std::uint8_t> message = sweep.message;
    const Joined there(sweep.there, message.data(), message.size());
    const Joined back(sweep.back, sweep.joins_back.data(), sweep.joins_back.size());
    for (std::uint64_t at = from; at < to; ++at) {
        const std::uint64_t index = sweep.index(at);
        if (!around(sweep, there, back, message.data(), index, tally)) tally.leave(index, most);
    }
}

// -- without the rest of the message --------------------------------------------------------------

// A number on its way through the bytes of a message of ROS, as CdrOutput and CdrInput take it.
class Cell {
public:
    explicit Cell(Check& check) : check_(check) {}

    template <class Real>
    double real(double value) {
        return static_cast<double>(precise<Real>(check_, value));
    }

    template <class Integer>
    std::int64_t integer(std::int64_t value) {
        check_.require(static_cast<std::int64_t>(static_cast<Integer>(value)) == value &&
                       !(std::is_unsigned_v<Integer> && value < 0));
        return value;
    }

private:
    Check& check_;
};

// The same for the steps of one number of 32 bits of a JAUS message, while the rest of the message
// stays as the functions of the bridge make it.
template <class Jaus, class Ros, class Read, class There, class Pass, class Back, class Write>
void alone(const Sweep& sweep, std::uint64_t from, std::uint64_t to, std::size_t most, Tally& tally,
           const Read& read, const There& there, const Pass& pass, const Back& back,
           const Write& write) {
    const Number& number = sweep.number;
    const std::uint8_t* const message = sweep.message.data();
    Jaus source, returned;
    Made made{};
    Check check;
    const Joined way(sweep.there, message, sweep.message.size());
    const std::int64_t size = way.translate(message, way.size(), &made);
    if (size < 0) return;
    CdrInput between(made.data, static_cast<std::size_t>(size), check);
    if (!between.begin()) return;
    Ros target = Ros::read(between);
    if (!decode(message, way.size(), source) || !check.passed()) return;
    decode(message, way.size(), returned);

    enum class Outcome { passed, left, left_out };
    const auto go = [&](std::uint64_t raw, std::uint64_t& found) {
        Check checked;
        const auto given = static_cast<std::uint32_t>(raw);
        JausInput in(reinterpret_cast<const std::uint8_t*>(&given), sizeof given, checked);
        read(in, source);
        there(source, target, sweep.there.live, checked);
        pass(Cell(checked), target);
        back(target, returned, sweep.back.live, checked);
        std::uint32_t result = 0;
        JausOutput out(reinterpret_cast<std::uint8_t*>(&result), sizeof result, checked);
        const bool is_there = write(out, returned);
        if (!checked.passed()) return Outcome::left;
        found = result;
        return is_there ? Outcome::passed : Outcome::left_out;
    };
    for (std::uint64_t at = from; at < to; ++at) {
        const std::uint64_t index = sweep.index(at), raw = number.raw(index);
        std::uint64_t found = 0, again = 0;
        const Outcome outcome = go(raw, found);
        if (outcome == Outcome::left) {
            tally.leave(index, most);
        } else if (outcome == Outcome::left_out) {
            ++tally.left_out;
        } else {
            tally.result.see(number.value(found));
            if (found == raw || number.distance(raw, found) == 0.0) {
                ++tally.unchanged;
                continue;
            }
            tally.note_error(number, index, raw, found);
            if (go(found, again) == Outcome::passed) tally.note_drift(number, index, found, again);
        }
    }
}

// -- the program ----------------------------------------------------------------------------------

using Run = void (*)(const Sweep&, std::uint64_t, std::uint64_t, std::size_t, Tally&);

// Runs a sweep in threads, each of which takes the next part.
inline Tally run(const Sweep& sweep, Run function, unsigned threads, std::size_t most) {
    const std::uint64_t parts = std::min<std::uint64_t>(sweep.count, 64 * threads);
    std::vector<Tally> found(parts);
    std::atomic<std::uint64_t> next{0};
    const auto work = [&] {
        for (std::uint64_t at = next++; at < parts; at = next++) {
            const std::uint64_t from = sweep.count * at / parts, to = sweep.count * (at + 1) / parts;
            found[at].count = to - from;
            found[at].watched.resize(sweep.watched.size());
            function(sweep, from, to, most, found[at]);
        }
    };
    std::vector<std::thread> others;
    for (unsigned at = 1; at < threads; ++at) others.emplace_back(work);
    work();
    for (std::thread& each : others) each.join();
    Tally all;
    for (const Tally& each : found) all.follow(each, most);
    return all;
}

// Words of a request: decimal integers, hexadecimal numbers and bytes, names.
class Words {
public:
    std::string word() {
        std::string found;
        std::cin >> found;
        return found;
    }
    std::uint64_t integer() { return std::strtoull(word().c_str(), nullptr, 10); }
    double real() { return std::strtod(word().c_str(), nullptr); }
    std::vector<std::uint8_t> bytes() {
        const std::string text = word();
        std::vector<std::uint8_t> found(text.size() / 2);
        for (std::size_t at = 0; at < found.size(); ++at) {
            const std::string digits = text.substr(2 * at, 2);
            found[at] = static_cast<std::uint8_t>(std::strtoul(digits.c_str(), nullptr, 16));
        }
        return found;
    }
    Number number() {
        Number found{};
        for (std::uint64_t* each : {&found.at, &found.size, &found.bits, &found.shift, &found.kind})
            *each = integer();
        for (double* each : {&found.lower, &found.step, &found.turn}) *each = real();
        return found;
    }
    template <class Item, class Read>
    std::vector<Item> list(const Read& read) {
        std::vector<Item> found(integer());
        for (Item& each : found) each = (this->*read)();
        return found;
    }
};

inline void put(std::uint64_t value) { std::printf("%llu ", static_cast<unsigned long long>(value)); }
inline void put(double value) { std::printf("%.17g ", value); }
inline void put(const Course& course) {
    for (const double each : {course.least, course.greatest}) put(each);
    for (const std::uint64_t each : {course.seen, course.rises, course.falls}) put(each);
}
template <class List>
void put_list(const List& values) {
    put(std::uint64_t{values.size()});
    for (const auto& each : values) put(each);
}
inline void put(const Tally& tally) {
    for (const std::uint64_t each : {tally.count, tally.unchanged, tally.changed, tally.left_out,
                                     tally.others, tally.drifting, tally.left, tally.largest_at,
                                     tally.largest_back, tally.drift_at})
        put(each);
    for (const double each : {tally.largest, tally.largest_drift}) put(each);
    put(tally.result);
    put_list(tally.watched);
    put_list(tally.examples);
    put_list(tally.bins);
}

// Answers requests, a line each, until the input ends. Ways are those to ROS and to JAUS.
inline int serve(const Way (&ways)[2], const std::vector<Run>& runs) {
    Words words;
    for (std::string what = words.word(); !what.empty(); what = words.word()) {
        const Way there = ways[words.integer()];
        if (what == "translate") {
            const std::vector<std::uint8_t> message = words.bytes();
            Made made{};
            const Joined joined(there, message.data(), message.size());
            const std::int64_t size = joined.translate(message.data(), joined.size(), &made);
            for (std::int64_t at = 0; at < size; ++at) std::printf("%02x", made.data[at]);
            std::printf(size < 0 ? "-\n" : "\n");
        } else {
            Sweep sweep{};
            sweep.there = there;
            const std::uint64_t back = words.integer();
            if (back < 2) sweep.back = ways[back];
            const Run function = runs.at(words.integer());
            const auto threads = static_cast<unsigned>(words.integer());
            const std::size_t most = words.integer();
            sweep.message = words.bytes();
            sweep.joins_back = words.bytes();
            sweep.between = words.integer();
            sweep.number = words.number();
            sweep.watched = words.list<Number>(&Words::number);
            sweep.varied = words.list<Number>(&Words::number);
            sweep.first = words.integer();
            sweep.count = words.integer();
            sweep.listed = words.list<std::uint64_t>(&Words::integer);
            put(run(sweep, function, threads, most));
            std::printf("\n");
        }
        std::fflush(stdout);
    }
    return 0;
}

}  // namespace jausml::proof
