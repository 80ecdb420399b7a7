/*
 * Layout of every public struct and value of every public constant that libtribo adds, and of the
 * structs of libtribo_core that hold pointers; the golden is layout_tribo.txt.
 */
#include <tribo/broad.h>
#include <tribo/collide.h>
#include <tribo/scene.h>
#include <tribo/shape.h>
#include <tribo/sparse.h>

#include <inttypes.h>
#include <stdio.h>

#define TYPE(type) printf("%s size %u\n", #type, (unsigned)sizeof(type))
#define FIELD(type, field)                                                              \
    printf("%s.%s offset %u size %u\n", #type, #field, (unsigned)offsetof(type, field), \
           (unsigned)sizeof(((type *)0)->field))
#define CONSTANT(name) printf("%s %" PRId64 "\n", #name, (int64_t)(name))

static void print_shape(void)
{
    CONSTANT(TRIBO_SHAPE_SPHERE);
    CONSTANT(TRIBO_SHAPE_BOX);
    CONSTANT(TRIBO_SHAPE_CAPSULE);
    CONSTANT(TRIBO_SHAPE_CYLINDER);
    CONSTANT(TRIBO_SHAPE_CONE);
    CONSTANT(TRIBO_SHAPE_ELLIPSOID);
    CONSTANT(TRIBO_SHAPE_HULL);
    CONSTANT(TRIBO_SHAPE_CONVEX);
    CONSTANT(TRIBO_SHAPE_HALFSPACE);
    CONSTANT(TRIBO_SHAPE_MESH);
    CONSTANT(TRIBO_SHAPE_COMPOUND);
    TYPE(tribo_shape);
    FIELD(tribo_shape, type);
    FIELD(tribo_shape, count);
    FIELD(tribo_shape, size);
    FIELD(tribo_shape, data);
    TYPE(tribo_pose);
    FIELD(tribo_pose, position);
    FIELD(tribo_pose, orientation);
    TYPE(tribo_child);
    FIELD(tribo_child, shape);
    FIELD(tribo_child, pose);
    TYPE(tribo_convex);
    FIELD(tribo_convex, struct_size);
    FIELD(tribo_convex, reserved);
    FIELD(tribo_convex, support);
    FIELD(tribo_convex, face);
    FIELD(tribo_convex, user);
    FIELD(tribo_convex, center);
    FIELD(tribo_convex, radius);
}

static void print_collide(void)
{
    CONSTANT(TRIBO_METHOD_AUTOMATIC);
    CONSTANT(TRIBO_METHOD_CLOSED);
    CONSTANT(TRIBO_METHOD_GENERAL);
    TYPE(tribo_point);
    FIELD(tribo_point, arm_a);
    FIELD(tribo_point, arm_b);
    FIELD(tribo_point, distance);
    FIELD(tribo_point, id);
    TYPE(tribo_manifold);
    FIELD(tribo_manifold, count);
    FIELD(tribo_manifold, child_a);
    FIELD(tribo_manifold, child_b);
    FIELD(tribo_manifold, method);
    FIELD(tribo_manifold, normal);
    FIELD(tribo_manifold, points);
    TYPE(tribo_collide_options);
    FIELD(tribo_collide_options, struct_size);
    FIELD(tribo_collide_options, method);
    FIELD(tribo_collide_options, max_points);
    FIELD(tribo_collide_options, reserved);
    FIELD(tribo_collide_options, margin);
    TYPE(tribo_collide_info);
    FIELD(tribo_collide_info, struct_size);
    FIELD(tribo_collide_info, closed);
    FIELD(tribo_collide_info, general);
    FIELD(tribo_collide_info, capped);
    FIELD(tribo_collide_info, supports);
    FIELD(tribo_collide_info, mallocs);
}

static void print_sparse(void)
{
    CONSTANT(TRIBO_SPARSE_AUTO);
    CONSTANT(TRIBO_SPARSE_SIMPLICIAL);
    CONSTANT(TRIBO_SPARSE_SUPERNODAL);
    TYPE(tribo_allocator);
    FIELD(tribo_allocator, struct_size);
    FIELD(tribo_allocator, reserved);
    FIELD(tribo_allocator, allocate);
    FIELD(tribo_allocator, release);
    FIELD(tribo_allocator, user);
    TYPE(tribo_sparse_info);
    FIELD(tribo_sparse_info, struct_size);
    FIELD(tribo_sparse_info, method);
    FIELD(tribo_sparse_info, factorizations);
    FIELD(tribo_sparse_info, analyses);
    FIELD(tribo_sparse_info, solves);
    FIELD(tribo_sparse_info, bytes);
    FIELD(tribo_sparse_info, fill);
}

static void print_scene(void)
{
    CONSTANT(TRIBO_BODY_DYNAMIC);
    CONSTANT(TRIBO_BODY_KINEMATIC);
    CONSTANT(TRIBO_BODY_STATIC);
    CONSTANT(TRIBO_SKIP_WARM_START);
    CONSTANT(TRIBO_SKIP_CORRECTION);
    CONSTANT(TRIBO_SKIP_RESTITUTION);
    CONSTANT(TRIBO_SKIP_SPECULATION);
    CONSTANT(TRIBO_EVENT_BEGIN);
    CONSTANT(TRIBO_EVENT_PERSIST);
    CONSTANT(TRIBO_EVENT_END);
    TYPE(tribo_scene_settings);
    FIELD(tribo_scene_settings, struct_size);
    FIELD(tribo_scene_settings, friction_rule);
    FIELD(tribo_scene_settings, restitution_rule);
    FIELD(tribo_scene_settings, reserved);
    FIELD(tribo_scene_settings, gravity);
    TYPE(tribo_scene_body);
    FIELD(tribo_scene_body, struct_size);
    FIELD(tribo_scene_body, kind);
    FIELD(tribo_scene_body, state);
    FIELD(tribo_scene_body, shape);
    FIELD(tribo_scene_body, offset);
    FIELD(tribo_scene_body, material);
    FIELD(tribo_scene_body, belt);
    FIELD(tribo_scene_body, rolling);
    FIELD(tribo_scene_body, spinning);
    TYPE(tribo_step_options);
    FIELD(tribo_step_options, struct_size);
    FIELD(tribo_step_options, substeps);
    FIELD(tribo_step_options, solver);
    FIELD(tribo_step_options, skip);
    FIELD(tribo_step_options, max_iterations);
    FIELD(tribo_step_options, tolerance);
    FIELD(tribo_step_options, margin);
    FIELD(tribo_step_options, threshold);
    FIELD(tribo_step_options, correction);
    FIELD(tribo_step_options, sleep_time);
    FIELD(tribo_step_options, sleep_speed);
    FIELD(tribo_step_options, tasks);
    FIELD(tribo_step_options, reserved);
    FIELD(tribo_step_options, parallel);
    FIELD(tribo_step_options, user);
    TYPE(tribo_step_info);
    FIELD(tribo_step_info, struct_size);
    FIELD(tribo_step_info, substeps);
    FIELD(tribo_step_info, stop);
    FIELD(tribo_step_info, asleep);
    FIELD(tribo_step_info, flights);
    FIELD(tribo_step_info, turns);
    FIELD(tribo_step_info, broad);
    FIELD(tribo_step_info, pairs);
    FIELD(tribo_step_info, contacts);
    FIELD(tribo_step_info, frictionless);
    FIELD(tribo_step_info, resisting);
    FIELD(tribo_step_info, matched);
    FIELD(tribo_step_info, contact_solves);
    FIELD(tribo_step_info, impact_solves);
    FIELD(tribo_step_info, impacts);
    FIELD(tribo_step_info, correction_solves);
    FIELD(tribo_step_info, sweeps);
    FIELD(tribo_step_info, newton_steps);
    FIELD(tribo_step_info, factorizations);
    FIELD(tribo_step_info, eta);
    FIELD(tribo_step_info, restitution);
    FIELD(tribo_step_info, penetration);
    TYPE(tribo_scene_contact);
    FIELD(tribo_scene_contact, a);
    FIELD(tribo_scene_contact, b);
    FIELD(tribo_scene_contact, child_a);
    FIELD(tribo_scene_contact, child_b);
    FIELD(tribo_scene_contact, id);
    FIELD(tribo_scene_contact, normal);
    FIELD(tribo_scene_contact, arm_a);
    FIELD(tribo_scene_contact, arm_b);
    FIELD(tribo_scene_contact, distance);
    FIELD(tribo_scene_contact, impulse);
    FIELD(tribo_scene_contact, torque);
    TYPE(tribo_scene_event);
    FIELD(tribo_scene_event, kind);
    FIELD(tribo_scene_event, a);
    FIELD(tribo_scene_event, b);
    FIELD(tribo_scene_event, impacts);
    FIELD(tribo_scene_event, impulse);
    FIELD(tribo_scene_event, normal);
}

static void print_system(void)
{
    TYPE(tribo_linear);
    FIELD(tribo_linear, struct_size);
    FIELD(tribo_linear, reserved);
    FIELD(tribo_linear, context);
    FIELD(tribo_linear, factor);
    FIELD(tribo_linear, solve);
    FIELD(tribo_linear, sign);
    TYPE(tribo_system_options);
    FIELD(tribo_system_options, struct_size);
    FIELD(tribo_system_options, solver);
    FIELD(tribo_system_options, measure);
    FIELD(tribo_system_options, isa);
    FIELD(tribo_system_options, warm_start);
    FIELD(tribo_system_options, tasks);
    FIELD(tribo_system_options, max_iterations);
    FIELD(tribo_system_options, tolerance);
    FIELD(tribo_system_options, max_seconds);
    FIELD(tribo_system_options, dense_limit);
    FIELD(tribo_system_options, reserved);
    FIELD(tribo_system_options, linear);
    FIELD(tribo_system_options, progress);
    FIELD(tribo_system_options, parallel);
    FIELD(tribo_system_options, clock);
    FIELD(tribo_system_options, user);
    FIELD(tribo_system_options, torques);
}

int main(void)
{
    print_shape();
    print_collide();
    print_sparse();
    print_system();
    print_scene();
    return 0;
}
