/*
 * Layout of every public struct and value of every public constant that libtribo adds, and of the
 * structs of libtribo_core that hold pointers; the golden is layout_tribo.txt.
 */
#include <tribo/broad.h>
#include <tribo/collide.h>
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

static void print_system(void)
{
    TYPE(tribo_linear);
    FIELD(tribo_linear, struct_size);
    FIELD(tribo_linear, reserved);
    FIELD(tribo_linear, context);
    FIELD(tribo_linear, factor);
    FIELD(tribo_linear, solve);
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
}

int main(void)
{
    print_shape();
    print_collide();
    print_sparse();
    print_system();
    return 0;
}
