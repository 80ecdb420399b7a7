// tribo for C++17: objects that own what they hold, exceptions in place of statuses, arrays that
// know their length. One header, no macros, nothing but calls of the C library beneath.
//
// Structs are those of C (tribo_body, tribo_shape, ...): make them with {} and fill in what
// differs; struct_size is set here. What a function means, its units and its errors stand at the
// C function of the same name. Functions of C that own nothing (vectors, mass properties, mixing)
// are called as they are; tribo::check turns their status into an exception.
//
// Errors: tribo::error has the status, and its name and text; an array of the wrong length is
// std::invalid_argument. Threads: as in C; one scene, sparse or system is for one thread at a time.
#ifndef TRIBO_TRIBO_HPP
#define TRIBO_TRIBO_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <tribo/broad.h>
#include <tribo/collide.h>
#include <tribo/scene.h>
#include <tribo/sparse.h>
#include <tribo/tribo.h>

namespace tribo {

// ---- errors and arrays --------------------------------------------------------------------------

class error : public std::runtime_error {
  public:
    error(tribo_status status, const char *where)
        : std::runtime_error(std::string(where) + ": " + tribo_status_string(status) + " (" +
                             tribo_status_name(status) + ")"),
          status_(status)
    {
    }
    tribo_status status() const noexcept { return status_; }
    const char *name() const noexcept { return tribo_status_name(status_); }

  private:
    tribo_status status_;
};

inline void check(tribo_status status, const char *where = "tribo")
{
    if (status != TRIBO_OK) {
        throw error(status, where);
    }
}

/// A run of T that somebody else owns; made of std::vector, std::array, or pointer and length.
template <class T> class span {
  public:
    span() noexcept = default;
    span(T *data, std::size_t size) noexcept : data_(data), size_(size) {}
    template <class Container,
              class = std::enable_if_t<std::is_convertible<
                  decltype(std::declval<Container &>().data()), T *>::value>>
    span(Container &container) noexcept : data_(container.data()), size_(container.size())
    {
    }
    T *data() const noexcept { return data_; }
    std::size_t size() const noexcept { return size_; }

  private:
    T *data_ = nullptr;
    std::size_t size_ = 0;
};

using vec3 = std::array<double, 3>;
using sym3 = std::array<double, 6>;

namespace detail {

inline void require(bool holds, const char *what)
{
    if (!holds) {
        throw std::invalid_argument(what);
    }
}

/// A C struct with its size set, all else zero or as given.
template <class T> T sized(T value = T{})
{
    value.struct_size = sizeof(T);
    return value;
}

/// Storage aligned for double, of at least `bytes`.
class block {
  public:
    void reserve(std::size_t bytes)
    {
        const std::size_t count = (bytes + sizeof(double) - 1) / sizeof(double);
        if (count > numbers_.size()) {
            numbers_.resize(count);
        }
    }
    void *data() noexcept { return numbers_.data(); }
    const void *data() const noexcept { return numbers_.data(); }
    std::size_t bytes() const noexcept { return numbers_.size() * sizeof(double); }

  private:
    std::vector<double> numbers_;
};

/// A list whose length C tells: asked for with no room, then with enough.
template <class T, class Fill> std::vector<T> list(const char *where, Fill fill)
{
    std::size_t count = 0;
    tribo_status status = fill(std::size_t{0}, static_cast<T *>(nullptr), &count);
    std::vector<T> out(status == TRIBO_ERROR_CAPACITY ? count : 0);
    if (status == TRIBO_ERROR_CAPACITY) {
        status = fill(out.size(), out.data(), &count);
    }
    check(status, where);
    return out;
}

} // namespace detail

inline std::string version() { return tribo_version_string(); }

// ---- bodies -------------------------------------------------------------------------------------

/// An immovable body at the origin.
inline tribo_body fixed_body()
{
    tribo_body body;
    check(tribo_body_init(&body), "tribo_body_init");
    return body;
}

/// A body at the origin, at rest, of a mass and an inertia tensor.
inline tribo_body body_of(double mass, const std::array<double, 9> &inertia)
{
    tribo_body body = fixed_body();
    check(tribo_body_set_mass(&body, mass, inertia.data()), "tribo_body_set_mass");
    return body;
}

struct mass_properties {
    double mass;
    vec3 center;
    std::array<double, 9> inertia;
};

inline mass_properties shape_mass(const tribo_shape &shape, double density)
{
    mass_properties out;
    check(tribo_shape_mass(&shape, density, &out.mass, out.center.data(), out.inertia.data()),
          "tribo_shape_mass");
    return out;
}

// ---- one contact --------------------------------------------------------------------------------

struct solution {
    vec3 impulse;
    tribo_solve_info info;
};

inline solution solve(const sym3 &w, const vec3 &b, double mu_s, double mu_d)
{
    solution out{{}, detail::sized<tribo_solve_info>()};
    check(tribo_contact_solve(w.data(), b.data(), mu_s, mu_d, out.impulse.data(), &out.info),
          "tribo_contact_solve");
    return out;
}

inline solution solve(const std::array<double, 9> &w, const vec3 &b, double mu_s, double mu_d)
{
    solution out{{}, detail::sized<tribo_solve_info>()};
    check(tribo_contact_solve_general(w.data(), b.data(), mu_s, mu_d, out.impulse.data(),
                                      &out.info),
          "tribo_contact_solve_general");
    return out;
}

struct impact_result {
    vec3 impulse;
    tribo_impact_info info;
};

inline impact_result impact(const sym3 &w, const vec3 &u, const tribo_material &pair,
                            tribo_impact_options options = {})
{
    impact_result out{{}, detail::sized<tribo_impact_info>()};
    options = detail::sized(options);
    check(tribo_impact(w.data(), u.data(), &pair, &options, out.impulse.data(), &out.info),
          "tribo_impact");
    return out;
}

/// b may be null: the world.
inline tribo_collision_info collide(tribo_body &a, tribo_body *b, const vec3 &point,
                                    const vec3 &normal, const tribo_material &pair,
                                    tribo_impact_options options = {})
{
    auto info = detail::sized<tribo_collision_info>();
    options = detail::sized(options);
    check(tribo_collide(&a, b, point.data(), normal.data(), &pair, &options, &info),
          "tribo_collide");
    return info;
}

inline tribo_collision_info resolve(tribo_body &a, tribo_body *b, const tribo_contact &contact,
                                    const tribo_material &pair, tribo_impact_options options = {})
{
    auto info = detail::sized<tribo_collision_info>();
    options = detail::sized(options);
    check(tribo_contact_resolve(&a, b, &contact, &pair, &options, &info), "tribo_contact_resolve");
    return info;
}

// ---- batches: arrays of contacts, one after the other; lengths are judged -----------------------
// The status that these return is the first that is not TRIBO_OK; with `statuses` each contact has
// its own and nothing is thrown for it.

namespace detail {

inline void judge_batch(tribo_status status, span<tribo_status> statuses, const char *where)
{
    bool is_of_contact = false;
    for (std::size_t i = 0; i < statuses.size() && !is_of_contact; i++) {
        is_of_contact = statuses.data()[i] != TRIBO_OK;
    }
    if (!is_of_contact) {
        check(status, where);
    }
}

} // namespace detail

/// w: 6 per contact, b: 3, mu: 2, p: 3; modes and statuses may be empty.
inline void batch_solve(span<const double> w, span<const double> b, span<const double> mu,
                        span<double> p, span<std::uint32_t> modes = {},
                        span<tribo_status> statuses = {}, std::uint32_t isa = TRIBO_ISA_BEST)
{
    const std::size_t n = p.size() / 3;
    detail::require(p.size() == 3 * n && w.size() == 6 * n && b.size() == 3 * n &&
                        mu.size() == 2 * n && (modes.size() == 0 || modes.size() == n) &&
                        (statuses.size() == 0 || statuses.size() == n),
                    "batch_solve: lengths do not fit each other");
    detail::judge_batch(tribo_batch_solve(isa, n, w.data(), b.data(), mu.data(), p.data(),
                                          modes.data(), statuses.data()),
                        statuses, "tribo_batch_solve");
}

/// w: 6 per contact, u: 3, p: 3; modes and statuses may be empty.
inline void batch_impact(span<const double> w, span<const double> u,
                         span<const tribo_material> pairs, span<double> p,
                         span<std::uint32_t> modes = {}, span<tribo_status> statuses = {},
                         std::uint32_t isa = TRIBO_ISA_BEST)
{
    const std::size_t n = pairs.size();
    detail::require(w.size() == 6 * n && u.size() == 3 * n && p.size() == 3 * n &&
                        (modes.size() == 0 || modes.size() == n) &&
                        (statuses.size() == 0 || statuses.size() == n),
                    "batch_impact: lengths do not fit each other");
    detail::judge_batch(tribo_batch_impact(isa, n, w.data(), u.data(), pairs.data(), p.data(),
                                           modes.data(), statuses.data()),
                        statuses, "tribo_batch_impact");
}

/// pairs: 2 per contact, frames: 9 (may be empty), w: 6; statuses may be empty.
inline void batch_matrix(span<const tribo_body> bodies, span<const std::uint32_t> pairs,
                         span<const tribo_contact> contacts, span<double> frames, span<double> w,
                         span<tribo_status> statuses = {}, std::uint32_t isa = TRIBO_ISA_BEST)
{
    const std::size_t n = contacts.size();
    detail::require(pairs.size() == 2 * n && w.size() == 6 * n &&
                        (frames.size() == 0 || frames.size() == 9 * n) &&
                        (statuses.size() == 0 || statuses.size() == n),
                    "batch_matrix: lengths do not fit each other");
    detail::judge_batch(tribo_batch_matrix(isa, bodies.size(), bodies.data(), n, pairs.data(),
                                           contacts.data(), frames.data(), w.data(),
                                           statuses.data()),
                        statuses, "tribo_batch_matrix");
}

// ---- shapes -------------------------------------------------------------------------------------

inline tribo_shape sphere(double radius)
{
    return {TRIBO_SHAPE_SPHERE, 0, {radius}, nullptr};
}

/// Half-extents.
inline tribo_shape box(double hx, double hy, double hz)
{
    return {TRIBO_SHAPE_BOX, 0, {hx, hy, hz}, nullptr};
}

inline tribo_shape capsule(double radius, double half_height)
{
    return {TRIBO_SHAPE_CAPSULE, 0, {radius, half_height}, nullptr};
}

inline tribo_shape cylinder(double radius, double half_height)
{
    return {TRIBO_SHAPE_CYLINDER, 0, {radius, half_height}, nullptr};
}

inline tribo_shape cone(double radius, double half_height)
{
    return {TRIBO_SHAPE_CONE, 0, {radius, half_height}, nullptr};
}

inline tribo_shape ellipsoid(double a, double b, double c)
{
    return {TRIBO_SHAPE_ELLIPSOID, 0, {a, b, c}, nullptr};
}

/// n . x <= d.
inline tribo_shape halfspace(const vec3 &normal, double d)
{
    return {TRIBO_SHAPE_HALFSPACE, 0, {normal[0], normal[1], normal[2], d}, nullptr};
}

/// Convex hull of points; it must outlive the shapes that it gives.
class hull {
  public:
    /// points: 3 per point.
    explicit hull(span<const double> points)
    {
        const std::size_t n = points.size() / 3;
        std::size_t needed = 0;
        detail::require(points.size() == 3 * n, "hull: three numbers a point");
        tribo_status status = tribo_hull_build(n, points.data(), nullptr, 0, &needed);
        if (status == TRIBO_ERROR_CAPACITY) {
            block_.reserve(needed);
            status = tribo_hull_build(n, points.data(), block_.data(), block_.bytes(), &needed);
        }
        check(status, "tribo_hull_build");
    }
    hull(const hull &) = delete;
    hull &operator=(const hull &) = delete;
    hull(hull &&) noexcept = default;
    hull &operator=(hull &&) noexcept = default;

    tribo_shape shape() const { return {TRIBO_SHAPE_HULL, 0, {}, block_.data()}; }

    /// Numbers of vertices and faces.
    std::pair<std::uint32_t, std::uint32_t> counts() const
    {
        std::pair<std::uint32_t, std::uint32_t> out;
        check(tribo_hull_counts(block_.data(), &out.first, &out.second), "tribo_hull_counts");
        return out;
    }

  private:
    detail::block block_;
};

/// Static triangle mesh; it must outlive the shapes that it gives.
class mesh {
  public:
    /// vertices: 3 per vertex; triangles: 3 indices per triangle.
    mesh(span<const double> vertices, span<const std::uint32_t> triangles)
    {
        const std::size_t n = vertices.size() / 3;
        const std::size_t count = triangles.size() / 3;
        std::size_t needed = 0;
        detail::require(vertices.size() == 3 * n && triangles.size() == 3 * count,
                        "mesh: three numbers a vertex, three indices a triangle");
        tribo_status status = tribo_mesh_build(n, vertices.data(), count, triangles.data(), nullptr,
                                               0, &needed);
        if (status == TRIBO_ERROR_CAPACITY) {
            block_.reserve(needed);
            status = tribo_mesh_build(n, vertices.data(), count, triangles.data(), block_.data(),
                                      block_.bytes(), &needed);
        }
        check(status, "tribo_mesh_build");
    }
    mesh(const mesh &) = delete;
    mesh &operator=(const mesh &) = delete;
    mesh(mesh &&) noexcept = default;
    mesh &operator=(mesh &&) noexcept = default;

    tribo_shape shape() const { return {TRIBO_SHAPE_MESH, 0, {}, block_.data()}; }

  private:
    detail::block block_;
};

inline std::vector<tribo_manifold> collide(const tribo_shape &a, const tribo_pose &pose_a,
                                           const tribo_shape &b, const tribo_pose &pose_b,
                                           tribo_collide_options options = {},
                                           tribo_collide_info *info = nullptr)
{
    options = detail::sized(options);
    std::vector<tribo_manifold> out(4);
    std::uint32_t count = 0;
    tribo_status status = tribo_collide_shapes(&a, &pose_a, &b, &pose_b, &options,
                                               static_cast<std::uint32_t>(out.size()), out.data(),
                                               &count, info);
    if (status == TRIBO_ERROR_CAPACITY) {
        out.resize(count);
        status = tribo_collide_shapes(&a, &pose_a, &b, &pose_b, &options, count, out.data(), &count,
                                      info);
    }
    check(status, "tribo_collide_shapes");
    out.resize(count);
    return out;
}

/// pairs: 2 indices a pair; one manifold a pair; statuses may be empty.
inline std::vector<tribo_manifold> collide_batch(span<const tribo_shape> shapes,
                                                 span<const tribo_pose> poses,
                                                 span<const std::uint32_t> pairs,
                                                 tribo_collide_options options = {},
                                                 span<tribo_status> statuses = {},
                                                 tribo_collide_info *info = nullptr)
{
    const std::size_t n = pairs.size() / 2;
    detail::require(shapes.size() == poses.size() && pairs.size() == 2 * n &&
                        (statuses.size() == 0 || statuses.size() == n),
                    "collide_batch: lengths do not fit each other");
    options = detail::sized(options);
    std::vector<tribo_manifold> out(n);
    detail::judge_batch(tribo_collide_batch(static_cast<std::uint32_t>(shapes.size()),
                                            shapes.data(), poses.data(), n, pairs.data(), &options,
                                            out.data(), statuses.data(), info),
                        statuses, "tribo_collide_batch");
    return out;
}

/// Broad phase: a dynamic tree of boxes.
class tree {
  public:
    explicit tree(std::uint32_t capacity, double margin = 0.0)
    {
        detail::require(tribo_tree_size(capacity) > 0, "tree: capacity from 1 to 2^30");
        block_.reserve(tribo_tree_size(capacity));
        check(tribo_tree_init(block_.data(), capacity, margin, &tree_), "tribo_tree_init");
    }
    tree(const tree &) = delete;
    tree &operator=(const tree &) = delete;
    tree(tree &&) noexcept = default;
    tree &operator=(tree &&) noexcept = default;

    std::uint32_t add(const vec3 &low, const vec3 &high)
    {
        std::uint32_t id = 0;
        check(tribo_tree_add(tree_, low.data(), high.data(), &id), "tribo_tree_add");
        return id;
    }
    void move(std::uint32_t id, const vec3 &low, const vec3 &high)
    {
        check(tribo_tree_move(tree_, id, low.data(), high.data()), "tribo_tree_move");
    }
    void remove(std::uint32_t id) { check(tribo_tree_remove(tree_, id), "tribo_tree_remove"); }

    /// Two ids a pair, sorted.
    std::vector<std::array<std::uint32_t, 2>> pairs() const
    {
        using pair = std::array<std::uint32_t, 2>;
        return detail::list<pair>("tribo_tree_pairs",
                                  [this](std::size_t n, pair *out, std::size_t *count) {
                                      return tribo_tree_pairs(tree_, n, n > 0 ? out->data() : nullptr,
                                                              count);
                                  });
    }
    std::vector<std::uint32_t> query_box(const vec3 &low, const vec3 &high) const
    {
        return detail::list<std::uint32_t>(
            "tribo_tree_query_box", [&](std::size_t n, std::uint32_t *out, std::size_t *count) {
                return tribo_tree_query_box(tree_, low.data(), high.data(), n, out, count);
            });
    }
    std::vector<std::uint32_t> query_ray(const vec3 &from, const vec3 &to) const
    {
        return detail::list<std::uint32_t>(
            "tribo_tree_query_ray", [&](std::size_t n, std::uint32_t *out, std::size_t *count) {
                return tribo_tree_query_ray(tree_, from.data(), to.data(), n, out, count);
            });
    }

  private:
    detail::block block_;
    tribo_tree *tree_ = nullptr;
};

// ---- systems ------------------------------------------------------------------------------------

/// Sparse factorisations for large systems.
class sparse {
  public:
    explicit sparse(std::uint32_t method = TRIBO_SPARSE_AUTO)
    {
        tribo_sparse *made = nullptr;
        check(tribo_sparse_create(method, nullptr, &made), "tribo_sparse_create");
        sparse_.reset(made);
    }
    tribo_linear linear() const
    {
        auto out = detail::sized<tribo_linear>();
        check(tribo_sparse_linear(sparse_.get(), &out), "tribo_sparse_linear");
        return out;
    }
    tribo_sparse_info report() const
    {
        auto out = detail::sized<tribo_sparse_info>();
        check(tribo_sparse_report(sparse_.get(), &out), "tribo_sparse_report");
        return out;
    }

  private:
    struct destroyer {
        void operator()(tribo_sparse *s) const noexcept { tribo_sparse_destroy(s); }
    };
    std::unique_ptr<tribo_sparse, destroyer> sparse_;
};

/// Solves systems of bodies and contacts; keeps workspace, factorisations and results.
class system {
  public:
    /// options.warm_start = 1 starts from `impulses` and `torques`, if their number fits.
    const tribo_system_info &solve(span<const tribo_body> bodies,
                                   span<const tribo_system_contact> contacts,
                                   tribo_system_options options = {})
    {
        const std::size_t n = contacts.size();
        const tribo_linear linear = sparse_.linear();
        std::size_t size = 0;
        options = detail::sized(options);
        options.linear = options.linear != nullptr ? options.linear : &linear;
        detail::require(options.warm_start == 0 || impulses.size() == 3 * n,
                        "system: a warm start needs the impulses of as many contacts");
        check(tribo_system_workspace_size(bodies.size(), n, contacts.data(), &options, &size),
              "tribo_system_workspace_size");
        workspace_.reserve(size);
        impulses.resize(3 * n);
        torques.resize(3 * n);
        options.torques = torques.data();
        velocities.resize(6 * bodies.size());
        info = detail::sized<tribo_system_info>();
        check(tribo_system_solve(bodies.size(), bodies.data(), n, contacts.data(), &options,
                                 workspace_.data(), workspace_.bytes(), impulses.data(),
                                 velocities.data(), &info),
              "tribo_system_solve");
        return info;
    }

    /// The assembled form u = W r + q by blocks; row_starts and columns empty: W is dense.
    const tribo_system_info &solve_assembled(span<const std::uint32_t> row_starts,
                                             span<const std::uint32_t> columns,
                                             span<const double> blocks, span<const double> q,
                                             span<const double> mu,
                                             tribo_system_options options = {})
    {
        const std::size_t n = mu.size() / 2;
        const tribo_linear linear = sparse_.linear();
        std::size_t size = 0;
        options = detail::sized(options);
        options.linear = options.linear != nullptr ? options.linear : &linear;
        detail::require(mu.size() == 2 * n && q.size() == 3 * n,
                        "solve_assembled: q has 3, mu 2 numbers a contact");
        detail::require(row_starts.size() == 0
                            ? columns.size() == 0 && blocks.size() == 9 * n * n
                            : row_starts.size() == n + 1 && blocks.size() == 9 * columns.size() &&
                                  row_starts.data()[n] == columns.size(),
                        "solve_assembled: rows, columns and blocks do not fit each other");
        detail::require(options.warm_start == 0 || impulses.size() == 3 * n,
                        "system: a warm start needs the impulses of as many contacts");
        check(tribo_system_assembled_workspace_size(n, row_starts.data(), columns.data(), &options,
                                                    &size),
              "tribo_system_assembled_workspace_size");
        workspace_.reserve(size);
        impulses.resize(3 * n);
        torques.assign(3 * n, 0.0);
        velocities.resize(3 * n);
        info = detail::sized<tribo_system_info>();
        check(tribo_system_solve_assembled(n, row_starts.data(), columns.data(), blocks.data(),
                                           q.data(), mu.data(), &options, workspace_.data(),
                                           workspace_.bytes(), impulses.data(), velocities.data(),
                                           &info),
              "tribo_system_solve_assembled");
        return info;
    }

    /// Give the velocities of `solve` to the bodies.
    void apply(span<tribo_body> bodies) const
    {
        detail::require(velocities.size() == 6 * bodies.size(), "system: other bodies were solved");
        check(tribo_system_apply(bodies.size(), bodies.data(), velocities.data()),
              "tribo_system_apply");
    }

    std::vector<double> impulses;   ///< 3 per contact
    std::vector<double> torques;    ///< 3 per contact that resists rolling or spinning, else 0
    std::vector<double> velocities; ///< 6 per body; 3 per contact in the assembled form
    tribo_system_info info = {};

  private:
    sparse sparse_;
    detail::block workspace_;
};

// ---- scenes -------------------------------------------------------------------------------------

/// A dynamic body without shape or mass, at the origin, at rest.
inline tribo_scene_body scene_body()
{
    tribo_scene_body body;
    check(tribo_scene_body_init(&body), "tribo_scene_body_init");
    return body;
}

class scene {
  public:
    explicit scene(tribo_scene_settings settings = {})
    {
        settings = detail::sized(settings);
        tribo_scene *made = nullptr;
        check(tribo_scene_create(&settings, nullptr, &made), "tribo_scene_create");
        scene_.reset(made);
    }
    /// With gravity, m/s^2, all else by default.
    scene(double x, double y, double z)
        : scene([&] {
              tribo_scene_settings settings{};
              settings.gravity[0] = x;
              settings.gravity[1] = y;
              settings.gravity[2] = z;
              return settings;
          }())
    {
    }

    std::uint32_t add(const tribo_scene_body &body)
    {
        std::uint32_t id = 0;
        check(tribo_scene_add(scene_.get(), &body, &id), "tribo_scene_add");
        return id;
    }
    void remove(std::uint32_t id)
    {
        check(tribo_scene_remove(scene_.get(), id), "tribo_scene_remove");
    }

    tribo_step_info step(double dt, tribo_step_options options = {})
    {
        auto info = detail::sized<tribo_step_info>();
        options = detail::sized(options);
        check(tribo_scene_step(scene_.get(), dt, &options, &info), "tribo_scene_step");
        return info;
    }

    tribo_body body(std::uint32_t id) const
    {
        tribo_body out;
        check(tribo_scene_get_body(scene_.get(), id, &out, nullptr), "tribo_scene_get_body");
        return out;
    }
    bool asleep(std::uint32_t id) const
    {
        tribo_body unused;
        std::uint32_t out = 0;
        check(tribo_scene_get_body(scene_.get(), id, &unused, &out), "tribo_scene_get_body");
        return out != 0;
    }
    void set_body(std::uint32_t id, const tribo_body &state)
    {
        check(tribo_scene_set_body(scene_.get(), id, &state), "tribo_scene_set_body");
    }
    void set_force(std::uint32_t id, const vec3 &force, const vec3 &torque = {})
    {
        check(tribo_scene_set_force(scene_.get(), id, force.data(), torque.data()),
              "tribo_scene_set_force");
    }
    void set_gravity(const vec3 &gravity)
    {
        check(tribo_scene_set_gravity(scene_.get(), gravity.data()), "tribo_scene_set_gravity");
    }
    /// Number of bodies.
    std::uint32_t size() const
    {
        std::uint32_t out = 0;
        check(tribo_scene_counts(scene_.get(), &out, nullptr), "tribo_scene_counts");
        return out;
    }
    tribo_totals totals(const vec3 &origin = {}, double *potential = nullptr) const
    {
        tribo_totals out;
        check(tribo_scene_totals(scene_.get(), origin.data(), &out, potential),
              "tribo_scene_totals");
        return out;
    }
    std::vector<tribo_scene_contact> contacts() const
    {
        return detail::list<tribo_scene_contact>(
            "tribo_scene_contacts",
            [this](std::size_t n, tribo_scene_contact *out, std::size_t *count) {
                return tribo_scene_contacts(scene_.get(), n, out, count);
            });
    }
    std::vector<tribo_scene_event> events() const
    {
        return detail::list<tribo_scene_event>(
            "tribo_scene_events",
            [this](std::size_t n, tribo_scene_event *out, std::size_t *count) {
                return tribo_scene_events(scene_.get(), n, out, count);
            });
    }

    /// All of the scene; shapes are kept by the addresses of their data.
    std::vector<double> save() const
    {
        std::size_t needed = 0;
        tribo_scene_save(scene_.get(), nullptr, 0, &needed);
        std::vector<double> out((needed + sizeof(double) - 1) / sizeof(double));
        check(tribo_scene_save(scene_.get(), out.data(), out.size() * sizeof(double), &needed),
              "tribo_scene_save");
        return out;
    }
    void load(span<const double> saved)
    {
        check(tribo_scene_load(scene_.get(), saved.data(), saved.size() * sizeof(double)),
              "tribo_scene_load");
    }

  private:
    struct destroyer {
        void operator()(tribo_scene *s) const noexcept { tribo_scene_destroy(s); }
    };
    std::unique_ptr<tribo_scene, destroyer> scene_;
};

} // namespace tribo

#endif
