// A random walk of commands, stops, silences and contacts through the pins of colorlight_i5: walk.py.
#include <algorithm>
#include <climits>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <random>
#include <vector>
#include "Vcolorlight_i5.h"
#include "verilated.h"

// DIVIDER, SILENCE, PERIOD and BOUNCE come from walk.py, in cycles.
static long STOP; // most cycles from a command or a silence to rest
static Vcolorlight_i5 chip;
static long now = 0, event = 0;

static void fail(const char *why) {
    printf("event %ld, cycle %ld: %s\n", event, now, why);
    exit(1);
}

// What is known from the pins and from the answers alone.
struct Observer {
    bool asked = false, loaded = false, enabled = false, origin = false, running = false, held = false;
    long quiet_from = 0, end_from = LONG_MAX, heard = 0, runs = 0, ended = 0, steps = 0, most = 0;
    long count[3] = {0, 0, 0}, start[3] = {0, 0, 0};
    int last_step = 0;
    std::deque<long> edges[3];

    void look() {
        int step = chip.step;
        if (chip.stop) {
            if (!chip.enable_n || step || chip.tools) fail("the stop does not cut");
            loaded = enabled = origin = running = held = asked = false;
        }
        if (chip.enable_n && (step || chip.tools)) fail("a step or an output without an enable");
        if (chip.tools && !running) fail("an output that was not commanded");
        if (chip.tools & 8 && held && now > quiet_from) fail("the laser is on in a hold");
        if (chip.tools & 8 && now > end_from) fail("the laser is on after the end");
        if (enabled && !held && now - heard > SILENCE) held = true, quiet_from = now + STOP;
        int rising = step & ~last_step;
        last_step = step;
        for (int axis = 0; axis < 3; axis++)
            if (rising >> axis & 1) {
                if (!running) fail("a step that was not commanded");
                if (held && now > quiet_from) fail("a step in a hold");
                if (now > end_from) fail("a step after the end");
                count[axis] += chip.dir >> axis & 1 ? -1 : 1;
                steps++;
                edges[axis].push_back(now);
                if ((long)edges[axis].size() > most) {
                    if (now - edges[axis].front() < PERIOD) fail("an axis is faster than it may");
                    edges[axis].pop_front();
                }
            }
    }
    void accepted(int at, uint32_t data) {
        if (at == 0x00 && data == 1) {
            bool near = true;
            for (int axis = 0; axis < 3; axis++) near &= labs(count[axis] - start[axis]) <= 1;
            asked = loaded && enabled && origin;
            running |= asked && near; // one that runs is not begun again
            quiet_from = std::max(quiet_from, now + 3 * PERIOD); // a request, a tick, and a step to the first point
            runs += running;
            end_from = LONG_MAX;
        }
        if (at == 0x00 && data == 2) loaded = held = false, end_from = std::min(end_from, now + 2 * PERIOD);
        if (at == 0x00 && data == 4) end_from = std::min(end_from, now + STOP);
        if (at == 0x20) {
            if (data == 0 && !held) quiet_from = now + STOP;
            held = data == 0;
        }
        if (at == 0x108 && data == 1) enabled = true, heard = now;
        if (at == 0x108 && data == 2) loaded = enabled = origin = running = held = asked = false;
        if (at == 0x108 && data == 4) {
            origin = true;
            running |= asked; // a run that waits begins here
            for (int axis = 0; axis < 3; axis++) start[axis] = count[axis];
        }
    }
} observer;

static std::vector<uint8_t> came;
static int bits = 0, byte_in = 0;
static long sample = 0;

static void cycle() {
    chip.clk_25 = 1;
    chip.eval();
    chip.clk_25 = 0;
    chip.eval();
    now++;
    observer.look();
    if (!bits && !chip.uart_tx) bits = 1, byte_in = 0, sample = now + DIVIDER * 3 / 2;
    if (bits && now == sample) {
        if (bits <= 8) byte_in |= chip.uart_tx << (bits - 1);
        sample += DIVIDER;
        if (++bits == 10) bits = 0, came.push_back(byte_in);
    }
}

static void wait(long cycles) {
    while (cycles-- > 0) cycle();
}

static uint8_t number = 0;
static uint32_t answer;

// Send a request; whether it was carried out.
static bool ask(std::vector<uint8_t> request) {
    uint16_t sum = 0xFFFF;
    for (size_t i = 1; i < request.size(); i++) {
        sum ^= request[i] << 8;
        for (int k = 0; k < 8; k++) sum = sum << 1 ^ (sum & 0x8000 ? 0x1021 : 0);
    }
    request.push_back(sum >> 8);
    request.push_back(sum);
    came.clear();
    for (uint8_t byte : request) {
        int frame = byte << 1 | 0x200;
        for (int i = 0; i < 10; i++, frame >>= 1) chip.uart_rx = frame & 1, wait(DIVIDER);
    }
    observer.heard = now;
    for (int i = 0; i < 20000 && came.size() < 9; i++) cycle();
    if (came.size() < 9 || came[1] != request[1] || came[2] > 3) fail("no answer, or a wrong one");
    number = number % 255 + 1;
    answer = came[3] | came[4] << 8 | came[5] << 16 | (uint32_t)came[6] << 24;
    return came[2] == 0;
}

static bool write(int at, uint32_t data) {
    bool go = at == 0 && data == 1, asked = observer.asked, running = observer.running;
    long end_from = observer.end_from;
    if (go) observer.accepted(at, data); // it may move before its answer is through
    bool done = ask({0xA5, number, (uint8_t)(0x80 | at >> 2), (uint8_t)data, (uint8_t)(data >> 8), (uint8_t)(data >> 16),
                     (uint8_t)(data >> 24)});
    if (done && !go) observer.accepted(at, data);
    if (go && !done) observer.asked = asked, observer.running = running, observer.end_from = end_from;
    return done;
}

static uint32_t read(int at) {
    if (!ask({0xA5, number, (uint8_t)(at >> 2), 0, 0, 0, 0})) fail("a register cannot be read");
    return answer;
}

static std::vector<std::pair<int, uint32_t>> load;

static bool write_all() {
    for (size_t first = 0; first < load.size(); first += 200) {
        size_t size = std::min(load.size() - first, (size_t)200);
        std::vector<uint8_t> request = {0xB5, number, (uint8_t)size};
        for (size_t i = first; i < first + size; i++) {
            request.push_back(load[i].first >> 2);
            for (int k = 0; k < 32; k += 8) request.push_back(load[i].second >> k);
        }
        if (!ask(request)) return false;
    }
    return true;
}

int main(int argc, char **argv) {
    FILE *file = fopen(argv[1], "r");
    long events = atol(argv[2]), expected[3], seen_by[16] = {0}, braking;
    std::mt19937 random(atol(argv[3]));
    auto below = [&](long n) { return (long)(random() % n); };
    int at;
    unsigned data;
    long *first[] = {&braking, &observer.most, &expected[0], &expected[1], &expected[2]};
    for (long *one : first)
        if (fscanf(file, "%ld", one) != 1) return 2;
    STOP = (2 + braking) * PERIOD + 16; // a period to the tick, one ahead, the braking; 13 cycles to the pins
    std::vector<std::pair<int, uint32_t>> settings;
    while (fscanf(file, "%x %x", &at, &data) == 2) (at >= 0x100 ? settings : load).push_back({at, data});
    chip.stop = 0, chip.contacts = 0x7F, chip.uart_rx = 1;
    wait(200);
    for (auto one : settings)
        if (!write(one.first, one.second)) fail("a setting is refused");
    for (event = 0; event < events; event++) {
        Observer &o = observer;
        int kind = below(16);
        if (below(2)) kind = chip.stop ? 1 : !o.loaded ? 9 : !o.enabled ? 2 : !o.origin ? 4 : !o.running ? 5 : 15;
        seen_by[kind]++;
        if (kind == 0 && below(3) == 0) chip.stop = 1, wait(below(300));
        if (kind == 1) chip.stop = 0, wait(below(300));
        if (kind == 2 && write(0x108, 1) && chip.stop) fail("enabled under the stop");
        if (kind == 3 && below(3) == 0) write(0x108, 2);
        if (kind == 4 && !o.running) write(0x108, 4);
        if (kind == 5) write(0x00, 1);
        if (kind == 6) write(0x20, 0);
        if (kind == 7) write(0x20, 1 + below(300));
        if (kind == 8) wait(below(2) ? SILENCE + 500 + below(32 * PERIOD) : below(SILENCE - 2000));
        if (kind == 9 && !o.running && write(0x00, 2) && write_all()) o.loaded = !chip.stop;
        if (kind == 10) write(0x00, 4);
        if (kind == 12 && below(3) == 0) write(0x00, 2);
        if (kind == 13) write(0x184, 1 << 6);
        if (kind == 14) chip.contacts ^= 1 << 6, wait(below(3 * BOUNCE));
        if (kind == 15) wait(below(SILENCE - 2000));
        if (kind == 15 && below(4) == 0) // to the end, unless something keeps it
            for (int n = 0; n < 60 && !o.held && read(0x04) & 1; n++) wait(below(SILENCE - 2000));
        if (kind == 11 || (o.asked && below(3) == 0)) {
            uint32_t path = read(0x04), board = read(0x10C);
            bool over = !(path & 1) && !(board & 2);
            if (o.asked && over) {
                bool whole = o.running && (path & 2) && !(path & 0x7F00) && !(board & 0xFF00);
                for (int axis = 0; whole && axis < 3; axis++)
                    if (o.count[axis] - o.start[axis] != expected[axis]) fail("the path's end is missed");
                o.ended += whole;
                o.asked = o.running = false;
            }
            if (!(board & 4)) o.origin = o.loaded = false;
            if (read(0x188)) write(0x184, 0);
            if (board & 4)
                for (int axis = 0; axis < 3; axis++) {
                    int32_t made = read(0x128 + 4 * axis);
                    if (over && made != o.count[axis] - o.start[axis]) fail("STEPS are not those of the pins");
                }
        }
    }
    (void)argc;
    printf("%ld events, %ld cycles, %ld steps, %ld runs begun, %ld to their end: nothing moved that was not commanded\n",
           events, now, observer.steps, observer.runs, observer.ended);
    return !(observer.runs > events / 100 && observer.ended > events / 1000);
}
