// SPDX-License-Identifier: BSD-3-Clause
// sail.cpp -- weft in C++: a sail hangs in a gust, its corner is hauled in, and a saved
// moment is played again.
#include <cstdio>
#include <weft/weft.hpp>

namespace {

struct vertex { // of a vertex buffer
    float position[3], normal[3], uv[2];
};

weft_cloth_def sail()
{
    static const weft_pin top = [] {
        weft_pin pin{};
        pin.cols.last = -1; // row 0, all columns
        return pin;
    }();
    weft_cloth_def def = weft_cloth_def_default();
    def.rows = 20;
    def.cols = 25;
    def.spacing[0] = def.spacing[1] = 0.05;
    def.springs[WEFT_STRETCH] = { true, 400.0, 0.05 };
    def.springs[WEFT_SHEAR] = { true, 150.0, 0.02 };
    def.pins = &top;
    def.pin_count = 1;
    return def;
}

weft_sim_def stepper()
{
    weft_sim_def run = weft_sim_def_default();
    run.method = weft_plugin_method(weft_plugin_verlet(), "symplectic_euler");
    run.config.fixed_step = 5e-4; // [s]
    return run;
}

void play(weft::sim &sim, std::size_t corner)
{
    std::vector<vertex> buffer(sim.particles());
    for (int frame = 1; frame <= 60; ++frame) {
        if (frame == 10) {
            sim.set_wind({ 0.0, 0.0, 4.0 }, 0.3);
        } else if (frame == 40) {
            sim.reset_wind();
        }
        if (frame == 30) {
            sim.pin(corner, { -0.5, 0.2, 0.0 });
        } else if (frame == 50) {
            sim.unpin(corner);
        }
        sim.advance(frame / 60.0);
        sim.vertices(buffer[0].position, buffer[0].normal, sizeof(vertex));
        if (frame % 10 == 0) {
            const vertex &last = buffer[corner];
            std::printf("%.3f s %+.4f %+.4f %+.4f normal %+.3f %+.3f %+.3f\n", sim.time(),
                        last.position[0], last.position[1], last.position[2],
                        last.normal[0], last.normal[1], last.normal[2]);
        }
    }
}

} // namespace

int main()
{
    try {
        const weft::cloth cloth(sail());
        weft::sim sim(cloth, stepper());
        std::printf("%zu particles, %zu triangles\n", cloth.particles(),
                    cloth.triangles().size() / 3);
        play(sim, cloth.particles() - 1);
        const std::vector<unsigned char> moment = sim.save();
        sim.advance(1.2);
        const weft::vec3 there = sim.position(0), end = sim.position(499);
        sim.restore(moment);
        sim.advance(1.2);
        std::printf("%s\n", sim.position(0) == there && sim.position(499) == end
                                ? "the same again"
                                : "something else");
        sim.pin(500);
    } catch (const weft::error &wrong) {
        std::printf("refused: %s\n", wrong.what());
        return wrong.status == WEFT_INVALID ? 0 : 1;
    }
    return 1;
}
