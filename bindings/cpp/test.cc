// The C++ header against the test vectors of ../vectors.json, and what it promises on misuse. TAP.
//
//   test VECTORS
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <thread>
#include <tribo/tribo.hpp>

namespace {

// ---- the rule of vectors.c ----------------------------------------------------------------------

class draws {
  public:
    explicit draws(std::uint64_t seed) : state_(seed) {}
    double unit()
    {
        state_ += 0x9e3779b97f4a7c15u;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        z ^= z >> 31;
        return static_cast<double>(z >> 11) * 0x1p-53;
    }
    double side() { return 2.0 * unit() - 1.0; }
    tribo::vec3 sides()
    {
        const double x = side();
        const double y = side();
        return {x, y, side()};
    }
    tribo::sym3 matrix()
    {
        tribo::sym3 w{};
        for (std::size_t i = 0; i < 6; i++) {
            const bool is_diagonal = i == 0 || i == 3 || i == 5;
            w[i] = is_diagonal ? 2.0 + side() : 0.5 * side();
        }
        return w;
    }
    tribo_material pair()
    {
        tribo_material out{};
        out.mu_s = 2.0 * unit();
        out.mu_d = unit() * out.mu_s;
        out.e = unit();
        return out;
    }

  private:
    std::uint64_t state_;
};

class hash {
  public:
    void put(std::uint64_t word)
    {
        for (int i = 0; i < 8; i++) {
            value_ = (value_ ^ (word >> (8 * i) & 0xff)) * 0x100000001b3u;
        }
    }
    void put(const double *numbers, std::size_t count)
    {
        for (std::size_t i = 0; i < count; i++) {
            std::uint64_t word;
            std::memcpy(&word, &numbers[i], sizeof word);
            put(word);
        }
    }
    std::uint64_t value() const { return value_; }

  private:
    std::uint64_t value_ = 0xcbf29ce484222325u;
};

// A case whose call throws has its status as its only output.
template <class Call> void put_case(hash &h, Call call)
{
    try {
        call();
    } catch (const tribo::error &e) {
        h.put(static_cast<std::uint64_t>(e.status()));
    }
}

void turn(const tribo::vec3 &by, double q[4])
{
    tribo::check(tribo_quat_from_rotation_vector(by.data(), q));
}

// ---- the sets of vectors.c ----------------------------------------------------------------------

void do_solve(draws &d, hash &h, unsigned)
{
    const tribo::sym3 w = d.matrix();
    const tribo::vec3 b = d.sides();
    const tribo_material pair = d.pair();
    put_case(h, [&] {
        const tribo::solution out = tribo::solve(w, b, pair.mu_s, pair.mu_d);
        h.put(TRIBO_OK);
        h.put(out.impulse.data(), 3);
        h.put(out.info.mode);
    });
}

void do_impact(draws &d, hash &h, unsigned i)
{
    tribo_impact_options options{};
    options.law = i % 8;
    const tribo::sym3 w = d.matrix();
    const tribo::vec3 u = d.sides();
    const tribo_material pair = d.pair();
    put_case(h, [&] {
        const tribo::impact_result out = tribo::impact(w, u, pair, options);
        h.put(TRIBO_OK);
        h.put(out.impulse.data(), 3);
        h.put(out.info.mode);
        h.put(&out.info.energy, 1);
    });
}

tribo_body draw_box(draws &d)
{
    double half[3];
    double mass;
    std::array<double, 9> inertia;
    for (double &length : half) {
        length = 0.5 + d.unit();
    }
    tribo::check(tribo_mass_box(1000.0, half, &mass, inertia.data()));
    tribo_body body = tribo::body_of(mass, inertia);
    const tribo::vec3 position = d.sides();
    turn(d.sides(), body.orientation);
    const tribo::vec3 velocity = d.sides();
    const tribo::vec3 spin = d.sides();
    std::copy(position.begin(), position.end(), body.position);
    std::copy(velocity.begin(), velocity.end(), body.velocity);
    std::copy(spin.begin(), spin.end(), body.angular_velocity);
    return body;
}

void do_collide(draws &d, hash &h, unsigned)
{
    tribo_body a = draw_box(d);
    tribo_body b = draw_box(d);
    const tribo::vec3 point = d.sides();
    tribo::vec3 normal = d.sides();
    tribo::check(tribo_vec3_normalize(normal.data(), normal.data()));
    const tribo_material pair = d.pair();
    put_case(h, [&] {
        const tribo_collision_info info = tribo::collide(a, &b, point, normal, pair);
        h.put(TRIBO_OK);
        h.put(a.velocity, 3);
        h.put(a.angular_velocity, 3);
        h.put(b.velocity, 3);
        h.put(b.angular_velocity, 3);
        h.put(info.impulse, 3);
        h.put(&info.energy, 1);
    });
}

constexpr std::size_t batch = 100;

void put_batch(hash &h, const std::vector<double> &p, const std::vector<std::uint32_t> &modes)
{
    h.put(TRIBO_OK);
    h.put(p.data(), p.size());
    for (const std::uint32_t mode : modes) {
        h.put(mode);
    }
}

void do_batch_solve(draws &d, hash &h, unsigned)
{
    std::vector<double> w, b, mu, p(3 * batch);
    std::vector<std::uint32_t> modes(batch);
    for (std::size_t k = 0; k < batch; k++) {
        const tribo::sym3 matrix = d.matrix();
        const tribo::vec3 velocity = d.sides();
        const tribo_material pair = d.pair();
        w.insert(w.end(), matrix.begin(), matrix.end());
        b.insert(b.end(), velocity.begin(), velocity.end());
        mu.insert(mu.end(), {pair.mu_s, pair.mu_d});
    }
    tribo::batch_solve(w, b, mu, p, modes);
    put_batch(h, p, modes);
}

void do_batch_impact(draws &d, hash &h, unsigned)
{
    std::vector<double> w, u, p(3 * batch);
    std::vector<tribo_material> pairs;
    std::vector<std::uint32_t> modes(batch);
    for (std::size_t k = 0; k < batch; k++) {
        const tribo::sym3 matrix = d.matrix();
        const tribo::vec3 velocity = d.sides();
        w.insert(w.end(), matrix.begin(), matrix.end());
        u.insert(u.end(), velocity.begin(), velocity.end());
        pairs.push_back(d.pair());
    }
    tribo::batch_impact(w, u, pairs, p, modes);
    put_batch(h, p, modes);
}

void draw_shape(draws &d, unsigned i, tribo_shape &shape, tribo_pose &pose)
{
    shape = {i + 1, 0, {}, nullptr};
    for (int k = 0; k < 3; k++) {
        shape.size[k] = 0.25 + 0.5 * d.unit();
    }
    const tribo::vec3 position = d.sides();
    for (std::size_t k = 0; k < 3; k++) {
        pose.position[k] = 0.5 * position[k];
    }
    turn(d.sides(), pose.orientation);
}

void do_manifold(draws &d, hash &h, unsigned i)
{
    tribo_collide_options options{};
    options.margin = 0.015625;
    tribo_shape a, b;
    tribo_pose pose_a, pose_b;
    draw_shape(d, i % 6, a, pose_a);
    draw_shape(d, i / 6 % 6, b, pose_b);
    put_case(h, [&] {
        const std::vector<tribo_manifold> out = tribo::collide(a, pose_a, b, pose_b, options);
        h.put(TRIBO_OK);
        h.put(out.size());
        for (const tribo_manifold &m : out) {
            h.put(m.count);
            h.put(m.normal, 3);
            for (std::uint32_t k = 0; k < m.count; k++) {
                h.put(m.points[k].arm_a, 3);
                h.put(m.points[k].arm_b, 3);
                h.put(&m.points[k].distance, 1);
                h.put(m.points[k].id);
            }
        }
    });
}

void do_system(draws &d, hash &h, unsigned i)
{
    constexpr unsigned tower = 5;
    std::vector<tribo_body> bodies;
    std::vector<tribo_system_contact> contacts;
    const tribo::mass_properties solid = tribo::shape_mass(tribo::box(0.5, 0.5, 0.5), 1000.0);
    for (unsigned k = 0; k < tower; k++) {
        tribo_body body = tribo::body_of(solid.mass, solid.inertia);
        body.position[2] = k + 0.5;
        body.velocity[0] = 0.125 * d.side();
        body.velocity[1] = 0.125 * d.side();
        body.velocity[2] = -0.015625;
        for (double &spin : body.angular_velocity) {
            spin = 0.125 * d.side();
        }
        bodies.push_back(body);
        for (unsigned j = 0; j < 4; j++) {
            tribo_system_contact c{};
            c.a = k;
            c.b = k > 0 ? k - 1 : TRIBO_WORLD;
            c.dimension = 3;
            c.contact.normal[2] = 1.0;
            c.contact.arm_a[0] = c.contact.arm_b[0] = j % 2 == 0 ? -0.5 : 0.5;
            c.contact.arm_a[1] = c.contact.arm_b[1] = j / 2 == 0 ? -0.5 : 0.5;
            c.contact.arm_a[2] = -0.5;
            c.contact.arm_b[2] = 0.5;
            c.pair.mu_s = c.pair.mu_d = 0.5;
            contacts.push_back(c);
        }
    }
    tribo_system_options options{};
    options.solver = 1 + i % 2;
    options.tolerance = 0x1p-30;
    put_case(h, [&] {
        tribo::system system;
        system.solve(bodies, contacts, options);
        h.put(TRIBO_OK);
        h.put(system.impulses.data(), system.impulses.size());
        h.put(system.velocities.data(), system.velocities.size());
    });
}

tribo_scene_body scene_floor()
{
    tribo_scene_body floor = tribo::scene_body();
    floor.kind = TRIBO_BODY_STATIC;
    floor.shape = tribo::halfspace({0.0, 0.0, 1.0}, 0.0);
    floor.material.mu_s = floor.material.mu_d = 0.5;
    floor.material.e = 0.25;
    return floor;
}

void do_scene(draws &d, hash &h, unsigned)
{
    tribo::scene scene(0.0, 0.0, -9.8125);
    const tribo_scene_body floor = scene_floor();
    scene.add(floor);
    for (unsigned k = 0; k < 10; k++) {
        tribo_scene_body body = tribo::scene_body();
        body.material = floor.material;
        body.shape = {1 + k % 4, 0, {0.25, 0.25, 0.25}, nullptr};
        const tribo::mass_properties solid = tribo::shape_mass(body.shape, 1000.0);
        body.state = tribo::body_of(solid.mass, solid.inertia);
        body.state.position[0] = d.side();
        body.state.position[1] = d.side();
        body.state.position[2] = 1.0 + k;
        const tribo::vec3 velocity = d.sides();
        const tribo::vec3 spin = d.sides();
        std::copy(velocity.begin(), velocity.end(), body.state.velocity);
        std::copy(spin.begin(), spin.end(), body.state.angular_velocity);
        scene.add(body);
    }
    for (unsigned step = 1; step <= 1000; step++) {
        scene.step(0.00390625);
        for (std::uint32_t k = 1; step % 100 == 0 && k <= 10; k++) {
            const tribo_body body = scene.body(k);
            h.put(TRIBO_OK);
            h.put(body.position, 3);
            h.put(body.orientation, 4);
            h.put(body.velocity, 3);
            h.put(body.angular_velocity, 3);
        }
    }
}

// ---- misuse -------------------------------------------------------------------------------------

int number = 0, failures = 0;

void report(bool is_ok, const std::string &name)
{
    number++;
    failures += is_ok ? 0 : 1;
    std::printf("%sok %d - %s\n", is_ok ? "" : "not ", number, name.c_str());
}

template <class Exception, class Call> bool throws(Call call)
{
    try {
        call();
    } catch (const Exception &) {
        return true;
    } catch (...) {
    }
    return false;
}

template <class Call> tribo_status status_of(Call call)
{
    try {
        call();
    } catch (const tribo::error &e) {
        return e.status();
    }
    return TRIBO_OK;
}

void test_errors()
{
    const tribo::sym3 w{1, 0, 0, 1, 0, 1};
    const double nan = std::numeric_limits<double>::quiet_NaN();
    std::vector<double> three(3), four(4), six(6), two(2);
    tribo::scene scene(0.0, 0.0, -9.81);
    report(status_of([&] { tribo::solve(w, {nan, 0, 0}, 0.5, 0.5); }) == TRIBO_ERROR_NOT_FINITE,
           "NaN is refused");
    report(status_of([&] { tribo::solve(w, {-1, 0, 0}, 0.1, 0.5); }) == TRIBO_ERROR_FRICTION,
           "mu_d above mu_s is refused");
    report(status_of([&] { scene.body(7); }) == TRIBO_ERROR_INDEX, "no such body");
    report(status_of([&] { scene.step(-1.0); }) == TRIBO_ERROR_TIME_STEP, "no negative time step");
    report(throws<std::invalid_argument>([&] { tribo::batch_solve(six, four, two, three); }),
           "lengths of arrays must fit");
    report(status_of([&] { tribo::hull hull(six); }) == TRIBO_ERROR_RANGE, "two points are no hull");
    report(status_of([&] { tribo::tree tree(4, nan); }) == TRIBO_ERROR_NOT_FINITE,
           "no tree with a margin that is not a number");
    report(status_of([&] { scene.load(six); }) == TRIBO_ERROR_DATA, "no scene in other data");
}

void test_statuses(const nlohmann::json &vectors)
{
    bool is_ok = true;
    for (const nlohmann::json &status : vectors["statuses"]) {
        const tribo_status value = status["value"];
        if (value != TRIBO_OK) {
            const tribo_status seen = status_of([&] { tribo::check(value, "here"); });
            const tribo::error e(value, "here");
            is_ok = is_ok && seen == value && e.name() == status["name"] &&
                    std::string(e.what()).find(status["text"]) != std::string::npos;
        }
    }
    report(is_ok, "every status is an exception with its name and text");
}

void test_objects()
{
    tribo::scene scene(0.0, 0.0, -9.81);
    scene.add(scene_floor());
    tribo_scene_body ball = tribo::scene_body();
    ball.shape = tribo::sphere(0.5);
    const tribo::mass_properties solid = tribo::shape_mass(ball.shape, 1.0);
    ball.state = tribo::body_of(solid.mass, solid.inertia);
    ball.state.position[2] = 0.75;
    const std::uint32_t id = scene.add(ball);
    const std::vector<double> saved = scene.save();
    const auto run = [&] {
        for (int i = 0; i < 100; i++) {
            scene.step(0.0078125);
        }
        return scene.body(id);
    };
    const tribo_body first = run();
    scene.load(saved);
    const tribo_body second = run();
    report(std::memcmp(&first, &second, sizeof first) == 0, "a saved scene goes on to the bit");
    report(scene.contacts().size() == 1 && scene.events().size() == 1, "contacts and events");

    tribo::scene moved = std::move(scene);
    report(moved.size() == 2, "scenes can be moved");

    tribo::tree tree(8);
    tree.add({0, 0, 0}, {1, 1, 1});
    tree.add({0.5, 0, 0}, {2, 1, 1});
    tree.add({5, 0, 0}, {6, 1, 1});
    const tribo::tree other = std::move(tree);
    report(other.pairs().size() == 1 && other.query_ray({-1, 0.5, 0.5}, {9, 0.5, 0.5}).size() == 3 &&
               other.query_box({4, 0, 0}, {7, 1, 1}).size() == 1,
           "the tree finds pairs, boxes and rays");

    bool equal[2] = {false, false};
    std::thread threads[2];
    for (int t = 0; t < 2; t++) {
        threads[t] = std::thread([&equal, t] {
            hash h;
            draws d(8);
            do_scene(d, h, 0);
            hash again;
            draws e(8);
            do_scene(e, again, 0);
            equal[t] = h.value() == again.value();
        });
    }
    for (std::thread &thread : threads) {
        thread.join();
    }
    report(equal[0] && equal[1], "two scenes in two threads");
}

} // namespace

int main(int argc, char **argv)
{
    const std::pair<const char *, void (*)(draws &, hash &, unsigned)> sets[] = {
        {"solve", do_solve},           {"impact", do_impact},
        {"collide", do_collide},       {"batch_solve", do_batch_solve},
        {"batch_impact", do_batch_impact}, {"manifold", do_manifold},
        {"system", do_system},         {"scene", do_scene}};
    std::ifstream file(argc > 1 ? argv[1] : "");
    const nlohmann::json vectors = nlohmann::json::parse(file);
    for (const nlohmann::json &expected : vectors["sets"]) {
        const std::string name = expected["name"];
        bool is_equal = false;
        for (const auto &set : sets) {
            if (name == set.first) {
                draws d(expected["seed"].get<std::uint64_t>());
                hash h;
                for (unsigned i = 0; i < expected["count"].get<unsigned>(); i++) {
                    set.second(d, h, i);
                }
                is_equal = h.value() ==
                           std::stoull(expected["hash"].get<std::string>(), nullptr, 16);
            }
        }
        report(is_equal, "vectors " + name);
    }
    test_statuses(vectors);
    test_errors();
    test_objects();
    std::printf("1..%d\n", number);
    return failures > 0 ? 1 : 0;
}
