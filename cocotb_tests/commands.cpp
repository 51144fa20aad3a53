// Loads streamer.v bank by bank, draws an override in about every second period, tells rates and beats: commands.py.
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>
#include "Vstreamer.h"
#include "verilated.h"

struct Write { unsigned space, index; uint64_t data; };

int main(int, char **argv) {
    std::mt19937 random(atoi(argv[2]));
    auto draw = [&](int most) { return (int)(random() % most); };
    std::vector<std::vector<Write>> batches(1);
    FILE *file = fopen(argv[1], "r");
    Write one;
    while (fscanf(file, "%x %x %" SCNx64, &one.space, &one.index, &one.data) == 3) {
        if (one.space != 8) batches.back().push_back(one);
        else batches.emplace_back();
    }
    batches.pop_back();

    Vstreamer chip;
    size_t batch = 0, at = 0;
    bool went = false;
    chip.rst = 1, chip.rate = 256, chip.go = chip.stop = chip.load = chip.close = chip.ready = 0;
    for (long cycle = 0, quiet = 0; quiet < 1000000; cycle++, quiet++) {
        chip.clk = 0;
        chip.eval();
        if (chip.sampled) {
            if (chip.starved) return puts("end: a bank is awaited, though each was loaded as soon as it was open"), 1;
            printf("r %d\n", chip.rate);
            quiet = 0;
        }
        bool sampled = chip.sampled, last = chip.valid && chip.ready && chip.last;
        if (chip.valid && chip.ready) {
            printf("p %" PRIx64 " ", (uint64_t)chip.position);
            for (int word = 3; word >= 0; word--) printf("%08x", chip.point_out[word]);
            printf(" %x\n", chip.outputs);
            if (last) {
                printf("end %d %x\n", chip.stopped, chip.faults);
                return 0;
            }
        }
        chip.clk = 1;
        chip.eval();
        chip.rst = chip.go = chip.close = 0;
        if (sampled && draw(2)) {
            const int rates[] = {0, 256, 511, draw(40), draw(257), draw(512)};
            chip.rate = rates[draw(6)];
        }
        chip.ready = draw(4) > 0;
        // The next bank as soon as its bit is open: one number a cycle, then close; go after the first one.
        chip.load = 0;
        if (batch < batches.size() && cycle > 1 && (at || !(chip.closed >> (batch & 1) & 1))) {
            if (at < batches[batch].size()) {
                Write &write = batches[batch][at++];
                chip.load = 1, chip.load_space = write.space, chip.load_index = write.index;
                chip.load_data = write.data;
            } else {
                chip.load_space = 7, chip.load_index = batch & 1, chip.close = 1;
                batch++, at = 0;
            }
        }
        if (!went && batch == 1 && chip.closed & 1) chip.go = 1, went = true;
    }
    puts("end: it stands still");
    return 1;
}
