// SPDX-License-Identifier: BSD-3-Clause
// weft/weft.hpp -- libweft for C++17: objects that free themselves, failures as
// weft::error. The structs and the rest of the functions are those of weft/weft.h, which
// take what get() returns. Header-only.
//
// An object that uses another (a simulation its cloth, a scene its registry) must be
// destroyed first, as objects declared later are. Callbacks are called from C and must
// not throw.
#ifndef WEFT_WEFT_HPP
#define WEFT_WEFT_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "weft/plugins.h"
#include "weft/weft.h"

namespace weft {

/// x y z of a position [m], a velocity [m/s] or a direction.
using vec3 = std::array<double, 3>;

/// What a function of weft refused; what() is its message.
class error : public std::runtime_error {
public:
    /// Makes an exception of an error, with another message.
    /// @param of status and place
    /// @param message what() returns it
    explicit error(const weft_error &of, const std::string &message)
        : std::runtime_error(message), status(of.status), file(of.file), line(of.line),
          column(of.column)
    {
    }
    /// Makes an exception of an error.
    /// @param of status, message and place
    explicit error(const weft_error &of) : error(of, of.message) {}

    weft_status status; ///< never WEFT_OK
    std::string file;   ///< "": no file
    int line, column;   ///< from 1; 0: no place in a file
};

/// Calls a function of weft whose last argument is the error.
/// @param function of weft/weft.h, which returns a weft_status
/// @param arguments its arguments without the last
/// @throws error with what the function reported
template <typename Function, typename... Arguments>
void call(Function function, Arguments... arguments)
{
    weft_error err{};
    if (function(arguments..., &err) != WEFT_OK) {
        throw error(err);
    }
}

/// Destroys an object of C, for std::unique_ptr.
template <typename T, void (*destroy)(T *)> struct deleter {
    /// Destroys an object.
    /// @param object of C
    void operator()(T *object) const { destroy(object); }
};

/// What objects have in common: one owner, who may move it.
template <typename T, void (*destroy)(T *)> class handle {
public:
    /// Returns the object of C.
    /// @return for the functions of weft/weft.h; this object keeps it
    T *get() const { return object.get(); }

protected:
    explicit handle(T *made) : object(made) {}

    // Made by a function that takes a definition and a place for the object.
    template <typename Create, typename Definition>
    static T *make(Create create, const Definition &definition)
    {
        T *made = nullptr;
        call(create, &definition, &made);
        return made;
    }

private:
    std::unique_ptr<T, deleter<T, destroy>> object;
};

/// Plugins, linked in or loaded: weft/registry.h.
class registry : public handle<weft_registry, weft_registry_destroy> {
public:
    /// Creates a registry.
    /// @param def where plugins are searched
    /// @throws error as weft_registry_create
    explicit registry(const weft_registry_def &def = weft_registry_def_default())
        : handle(make(weft_registry_create, def))
    {
    }
    /// Adds a plugin that is linked in.
    /// @param plugin must outlive the registry
    /// @throws error as weft_registry_add
    void add(const weft_plugin *plugin) { call(weft_registry_add, get(), plugin); }
    /// Finds a plugin, and loads it if necessary.
    /// @param id such as "gsl"
    /// @return valid as long as the registry
    /// @throws error as weft_registry_find
    const weft_plugin *find(const std::string &id) const
    {
        const weft_plugin *plugin = nullptr;
        call(weft_registry_find, get(), id.c_str(), &plugin);
        return plugin;
    }
};

/// A scene, from a file or from text: weft/scene.h. The message of its error has all errors of the
/// scene, a line each.
class scene : public handle<weft_scene, weft_scene_destroy> {
public:
    /// Loads a scene.
    /// @param def a file or a text, overrides
    /// @param plugins must outlive the scene
    /// @throws error as weft_scene_load
    scene(const weft_scene_def &def, const registry &plugins)
        : handle(load(def, plugins))
    {
    }
    /// Loads a scene from a file.
    /// @param path of the file
    /// @param plugins must outlive the scene
    /// @return the scene
    /// @throws error as weft_scene_load
    static scene file(const std::string &path, const registry &plugins)
    {
        weft_scene_def def = weft_scene_def_default();
        def.file = path.c_str();
        return scene(def, plugins);
    }
    /// Loads a scene from a text.
    /// @param text YAML
    /// @param plugins must outlive the scene
    /// @return the scene
    /// @throws error as weft_scene_load
    static scene text(const std::string &text, const registry &plugins)
    {
        weft_scene_def def = weft_scene_def_default();
        def.text = text.c_str();
        def.length = text.size();
        return scene(def, plugins);
    }

private:
    static const weft_plugin *find(void *ctx, const char *id, weft_error *err)
    {
        const weft_plugin *plugin = nullptr;
        (void)weft_registry_find(static_cast<weft_registry *>(ctx), id, &plugin, err);
        return plugin;
    }
    static weft_scene *load(weft_scene_def def, const registry &plugins)
    {
        const auto found = std::make_unique<weft_diagnostics>();
        weft_scene *made = nullptr;
        weft_error err{};
        def.find_plugin = find;
        def.find_ctx = plugins.get();
        if (weft_scene_load(&def, &made, found.get(), &err) != WEFT_OK) {
            std::string message;
            for (std::size_t i = 0; i < found->count; ++i) {
                char one[2048];
                (void)weft_diagnostic_format(&found->items[i], one, sizeof one);
                message += (i == 0 ? "" : "\n") + std::string(one);
            }
            throw error(err, message.empty() ? err.message : message);
        }
        return made;
    }
};

/// A cloth, which is constant and may be shared by simulations in many threads: weft/cloth.h.
class cloth : public handle<weft_cloth, weft_cloth_destroy> {
public:
    /// Creates a cloth.
    /// @param def copied
    /// @throws error as weft_cloth_create
    explicit cloth(const weft_cloth_def &def) : handle(make(weft_cloth_create, def)) {}
    /// Creates the cloth of a scene.
    /// @param of the scene
    /// @throws error as weft_cloth_create
    explicit cloth(const scene &of) : cloth(*weft_scene_cloth(of.get())) {}

    /// Counts the particles.
    /// @return N
    std::size_t particles() const { return weft_cloth_particles(get()); }
    /// Lists the triangles.
    /// @return particle indices, three of each triangle
    std::vector<std::uint32_t> triangles() const
    {
        std::vector<std::uint32_t> corners(3 * weft_cloth_triangles(get(), nullptr));
        (void)weft_cloth_triangles(get(), corners.data());
        return corners;
    }
};

/// A simulation of a cloth, which must outlive it: weft/sim.h. One thread at a time; functions that
/// change it are called between two steps.
class sim : public handle<weft_sim, weft_sim_destroy> {
public:
    /// Creates a simulation at t = 0.
    /// @param of its cloth
    /// @param def method and settings; its cloth is replaced
    /// @throws error as weft_sim_create
    sim(const cloth &of, weft_sim_def def) : handle(create(of, def)) {}
    /// Creates a simulation as a scene defines it.
    /// @param of the scene's cloth
    /// @param defined the scene, which must outlive the simulation
    /// @throws error as weft_sim_create
    sim(const cloth &of, const scene &defined) : sim(of, definition(defined)) {}

    /// Returns the present time.
    /// @return [s]
    double time() const { return weft_sim_time(get()); }
    /// Takes one accepted step towards t_end.
    /// @param t_end [s] > time()
    /// @throws error as weft_sim_step
    void step(double t_end) { call(weft_sim_step, get(), t_end); }
    /// Steps until the time is exactly t_end, or an event.
    /// @param t_end [s] >= time(); compute it as i / fps
    /// @throws error as weft_sim_advance
    void advance(double t_end) { call(weft_sim_advance, get(), t_end); }

    /// Counts the particles.
    /// @return N
    std::size_t particles() const { return weft_cloth_particles(weft_sim_cloth(get())); }
    /// Copies the positions.
    /// @return [m], N of them: r * cols + c on a grid, the vertex index on a mesh
    std::vector<vec3> positions() const { return triples(weft_sim_positions); }
    /// Copies the velocities.
    /// @return [m/s], N of them
    std::vector<vec3> velocities() const { return triples(weft_sim_velocities); }
    /// Returns the position of one particle.
    /// @param particle < N
    /// @return [m]
    vec3 position(std::size_t particle) const
    {
        const weft_cloth *of = weft_sim_cloth(get());
        const double *y = weft_sim_state(get()) + weft_cloth_index(of, particle);
        return { y[0], y[particles()], y[2 * particles()] };
    }
    /// Fills a vertex buffer, as weft_sim_vertices does.
    /// @param positions [m] three floats of particle 0; nullptr: not wanted
    /// @param normals three floats of particle 0; nullptr: not wanted
    /// @param stride [bytes] from one particle to the next; 0: 12
    void vertices(float *positions, float *normals, std::size_t stride = 0) const
    {
        weft_sim_vertices(get(), positions, normals, stride);
    }

    /// Pins a particle where it is, and moves it from now on.
    /// @param particle < N
    /// @param velocity [m/s]
    /// @throws error as weft_sim_pin
    void pin(std::size_t particle, const vec3 &velocity = {})
    {
        call(weft_sim_pin, get(), particle, velocity.data());
    }
    /// Pins several particles.
    /// @param particles their indices
    /// @param velocities [m/s], one of each
    /// @throws std::invalid_argument if their numbers differ; error as weft_sim_pin_many
    void pin(const std::vector<std::size_t> &particles, const std::vector<vec3> &velocities)
    {
        if (particles.size() != velocities.size()) {
            throw std::invalid_argument("weft::sim::pin: as many velocities as particles");
        }
        call(weft_sim_pin_many, get(), particles.data(),
             velocities.empty() ? nullptr : velocities.front().data(), particles.size());
    }
    /// Moves a pinned particle to another place at once.
    /// @param particle < N
    /// @param position [m]
    /// @throws error as weft_sim_move_pin
    void move_pin(std::size_t particle, const vec3 &position)
    {
        call(weft_sim_move_pin, get(), particle, position.data());
    }
    /// Releases a pinned particle.
    /// @param particle < N
    /// @throws error as weft_sim_unpin
    void unpin(std::size_t particle) { call(weft_sim_unpin, get(), particle); }
    /// Changes the wind from now on.
    /// @param velocity [m/s]
    /// @param drag [kg/(m^2 s)] >= 0
    /// @throws error as weft_sim_set_wind
    void set_wind(const vec3 &velocity, double drag)
    {
        call(weft_sim_set_wind, get(), velocity.data(), drag);
    }
    /// Brings the definition's wind back.
    /// @throws error as weft_sim_set_wind
    void reset_wind() { call(weft_sim_set_wind, get(), nullptr, 0.0); }

    /// Adds a collider.
    /// @param shape copied
    /// @return its index
    /// @throws error as weft_sim_add_shape
    std::size_t add_shape(const weft_shape &shape)
    {
        std::size_t number = 0;
        call(weft_sim_add_shape, get(), &shape, &number);
        return number;
    }
    /// Moves a collider at a constant velocity from now on.
    /// @param shape its index
    /// @param velocity [m/s]
    /// @throws error as weft_sim_move_shape
    void move_shape(std::size_t shape, const vec3 &velocity)
    {
        call(weft_sim_move_shape, get(), shape, nullptr, velocity.data());
    }
    /// Gives a collider another motion from now on.
    /// @param shape its index
    /// @param as its velocity, amplitude, frequency and turn are used
    /// @throws error as weft_sim_drive_shape
    void drive_shape(std::size_t shape, const weft_shape &as)
    {
        call(weft_sim_drive_shape, get(), shape, &as);
    }
    /// Removes a collider.
    /// @param shape its index; those behind it get the next lower ones
    /// @throws error as weft_sim_remove_shape
    void remove_shape(std::size_t shape) { call(weft_sim_remove_shape, get(), shape); }

    /// Saves all data that the future of the simulation depends on.
    /// @return for restore()
    /// @throws error as weft_sim_save
    std::vector<unsigned char> save()
    {
        std::vector<unsigned char> bytes(weft_sim_save_size(get()));
        call(weft_sim_save, get(), bytes.data(), bytes.size());
        return bytes;
    }
    /// Puts the simulation where a saved one of the same definition was.
    /// @param bytes of save()
    /// @throws error as weft_sim_restore
    void restore(const std::vector<unsigned char> &bytes)
    {
        call(weft_sim_restore, get(), bytes.data(), bytes.size());
    }

private:
    static weft_sim *create(const cloth &of, weft_sim_def &def)
    {
        def.cloth = of.get();
        return make(weft_sim_create, def);
    }
    static weft_sim_def definition(const scene &of)
    {
        weft_sim_def def = weft_sim_def_default();
        def.method = weft_scene_method_type(of.get());
        def.config = *weft_scene_config(of.get());
        def.limit = *weft_scene_limit(of.get());
        return def;
    }
    std::vector<vec3> triples(void (*copy)(const weft_sim *, double *)) const
    {
        std::vector<vec3> of(particles());
        copy(get(), of.front().data());
        return of;
    }
};

} // namespace weft

#endif
