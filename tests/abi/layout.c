/*
 * Layout of every public struct without pointers and value of every public constant of
 * libtribo_core; the golden is layout.txt, the same on every machine. tests/abi.sh also checks that
 * no public struct, field or constant is missing here or in layout_tribo.c.
 */
#include <tribo/system.h>
#include <tribo/tribo.h>

#include <inttypes.h>
#include <stdio.h>

#define TYPE(type) printf("%s size %u\n", #type, (unsigned)sizeof(type))
#define FIELD(type, field)                                                              \
    printf("%s.%s offset %u size %u\n", #type, #field, (unsigned)offsetof(type, field), \
           (unsigned)sizeof(((type *)0)->field))
#define CONSTANT(name) printf("%s %" PRId64 "\n", #name, (int64_t)(name))

static void print_status(void)
{
    TYPE(tribo_status);
    CONSTANT(TRIBO_OK);
    CONSTANT(TRIBO_ERROR_NULL);
    CONSTANT(TRIBO_ERROR_STRUCT_SIZE);
    CONSTANT(TRIBO_ERROR_OPTION);
    CONSTANT(TRIBO_ERROR_INDEX);
    CONSTANT(TRIBO_ERROR_ISA);
    CONSTANT(TRIBO_ERROR_NAME);
    CONSTANT(TRIBO_ERROR_ALIAS);
    CONSTANT(TRIBO_ERROR_CAPACITY);
    CONSTANT(TRIBO_ERROR_MEMORY);
    CONSTANT(TRIBO_ERROR_DATA);
    CONSTANT(TRIBO_ERROR_NOT_FINITE);
    CONSTANT(TRIBO_ERROR_RANGE);
    CONSTANT(TRIBO_ERROR_NORMAL);
    CONSTANT(TRIBO_ERROR_ORIENTATION);
    CONSTANT(TRIBO_ERROR_FRAME);
    CONSTANT(TRIBO_ERROR_MASS);
    CONSTANT(TRIBO_ERROR_INERTIA);
    CONSTANT(TRIBO_ERROR_SHAPE);
    CONSTANT(TRIBO_ERROR_TIME_STEP);
    CONSTANT(TRIBO_ERROR_DEGENERATE);
    CONSTANT(TRIBO_ERROR_SUPPORT);
    CONSTANT(TRIBO_ERROR_PAIR);
    CONSTANT(TRIBO_ERROR_FRICTION);
    CONSTANT(TRIBO_ERROR_RESTITUTION);
    CONSTANT(TRIBO_ERROR_CONTACT_MATRIX);
    CONSTANT(TRIBO_ERROR_IMMOVABLE);
    CONSTANT(TRIBO_ERROR_JAM);
}

static void print_body(void)
{
    TYPE(tribo_body);
    FIELD(tribo_body, position);
    FIELD(tribo_body, orientation);
    FIELD(tribo_body, velocity);
    FIELD(tribo_body, angular_velocity);
    FIELD(tribo_body, inverse_mass);
    FIELD(tribo_body, inverse_inertia);
}

static void print_material(void)
{
    TYPE(tribo_material);
    FIELD(tribo_material, mu_s);
    FIELD(tribo_material, mu_d);
    FIELD(tribo_material, e);
    CONSTANT(TRIBO_MIX_GEOMETRIC_MEAN);
    CONSTANT(TRIBO_MIX_MINIMUM);
    CONSTANT(TRIBO_MIX_MAXIMUM);
    CONSTANT(TRIBO_MIX_PRODUCT);
    CONSTANT(TRIBO_MIX_ARITHMETIC_MEAN);
}

static void print_contact(void)
{
    TYPE(tribo_contact);
    FIELD(tribo_contact, normal);
    FIELD(tribo_contact, arm_a);
    FIELD(tribo_contact, arm_b);
    CONSTANT(TRIBO_MODE_OPEN);
    CONSTANT(TRIBO_MODE_STICK);
    CONSTANT(TRIBO_MODE_SLIP);
    CONSTANT(TRIBO_MODE_JAM);
    TYPE(tribo_solve_info);
    FIELD(tribo_solve_info, struct_size);
    FIELD(tribo_solve_info, mode);
    FIELD(tribo_solve_info, iterations);
    FIELD(tribo_solve_info, reserved);
    FIELD(tribo_solve_info, nu);
}

static void print_impact(void)
{
    CONSTANT(TRIBO_LAW_ALGEBRAIC);
    CONSTANT(TRIBO_LAW_FRICTIONLESS);
    CONSTANT(TRIBO_LAW_LECTURE);
    CONSTANT(TRIBO_LAW_COULOMB);
    CONSTANT(TRIBO_LAW_ROUTH_NEWTON);
    CONSTANT(TRIBO_LAW_ROUTH_POISSON);
    CONSTANT(TRIBO_LAW_ROUTH_STRONGE);
    CONSTANT(TRIBO_LAW_LECTURE_CLOSING);
    TYPE(tribo_impact_options);
    FIELD(tribo_impact_options, struct_size);
    FIELD(tribo_impact_options, law);
    FIELD(tribo_impact_options, tangential_restitution);
    TYPE(tribo_impact_info);
    FIELD(tribo_impact_info, struct_size);
    FIELD(tribo_impact_info, mode);
    FIELD(tribo_impact_info, iterations);
    FIELD(tribo_impact_info, reserved);
    FIELD(tribo_impact_info, velocity);
    FIELD(tribo_impact_info, energy);
    FIELD(tribo_impact_info, kappa);
    FIELD(tribo_impact_info, compression);
}

static void print_collision(void)
{
    TYPE(tribo_collision_info);
    FIELD(tribo_collision_info, struct_size);
    FIELD(tribo_collision_info, mode);
    FIELD(tribo_collision_info, iterations);
    FIELD(tribo_collision_info, reserved);
    FIELD(tribo_collision_info, frame);
    FIELD(tribo_collision_info, matrix);
    FIELD(tribo_collision_info, velocity_before);
    FIELD(tribo_collision_info, velocity_after);
    FIELD(tribo_collision_info, impulse);
    FIELD(tribo_collision_info, impulse_world);
    FIELD(tribo_collision_info, energy);
}

static void print_audit(void)
{
    TYPE(tribo_totals);
    FIELD(tribo_totals, linear);
    FIELD(tribo_totals, angular);
    FIELD(tribo_totals, energy);
    FIELD(tribo_totals, mass);
    FIELD(tribo_totals, linear_scale);
    FIELD(tribo_totals, angular_scale);
    TYPE(tribo_change);
    FIELD(tribo_change, linear);
    FIELD(tribo_change, angular);
    FIELD(tribo_change, energy);
    TYPE(tribo_measures);
    FIELD(tribo_measures, eta);
    FIELD(tribo_measures, signorini);
    FIELD(tribo_measures, cone);
    FIELD(tribo_measures, misalignment);
    FIELD(tribo_measures, energy);
    FIELD(tribo_measures, velocity);
}

static void print_batch(void)
{
    CONSTANT(TRIBO_WORLD);
    CONSTANT(TRIBO_ISA_BEST);
    CONSTANT(TRIBO_ISA_SCALAR);
    CONSTANT(TRIBO_ISA_BASELINE);
    CONSTANT(TRIBO_ISA_X86_64_V3);
    CONSTANT(TRIBO_ISA_X86_64_V4);
}

static void print_system(void)
{
    TYPE(tribo_system_contact);
    FIELD(tribo_system_contact, a);
    FIELD(tribo_system_contact, b);
    FIELD(tribo_system_contact, dimension);
    FIELD(tribo_system_contact, reserved);
    FIELD(tribo_system_contact, contact);
    FIELD(tribo_system_contact, pair);
    FIELD(tribo_system_contact, target);
    FIELD(tribo_system_contact, rolling);
    FIELD(tribo_system_contact, spinning);
    CONSTANT(TRIBO_SOLVER_AUTO);
    CONSTANT(TRIBO_SOLVER_GAUSS_SEIDEL);
    CONSTANT(TRIBO_SOLVER_NEWTON);
    CONSTANT(TRIBO_MEASURE_ETA);
    CONSTANT(TRIBO_MEASURE_INVARIANT);
    CONSTANT(TRIBO_STOP_TOLERANCE);
    CONSTANT(TRIBO_STOP_ITERATIONS);
    CONSTANT(TRIBO_STOP_TIME);
    CONSTANT(TRIBO_STOP_CANCEL);
    CONSTANT(TRIBO_STOP_STALL);
    CONSTANT(TRIBO_STOP_JAM);
}

static void print_system_info(void)
{
    TYPE(tribo_system_info);
    FIELD(tribo_system_info, struct_size);
    FIELD(tribo_system_info, stop);
    FIELD(tribo_system_info, solver);
    FIELD(tribo_system_info, components);
    FIELD(tribo_system_info, sweeps);
    FIELD(tribo_system_info, steps);
    FIELD(tribo_system_info, factorizations);
    FIELD(tribo_system_info, eta);
    FIELD(tribo_system_info, eta_rms);
    FIELD(tribo_system_info, signorini);
    FIELD(tribo_system_info, cone);
    FIELD(tribo_system_info, misalignment);
    FIELD(tribo_system_info, invariant);
    FIELD(tribo_system_info, siconos);
    FIELD(tribo_system_info, energy);
    FIELD(tribo_system_info, energy_scale);
    FIELD(tribo_system_info, linear);
    FIELD(tribo_system_info, angular);
    FIELD(tribo_system_info, restitution);
    FIELD(tribo_system_info, seconds);
    FIELD(tribo_system_info, bytes);
}

int main(void)
{
    print_status();
    print_body();
    print_material();
    print_contact();
    print_impact();
    print_collision();
    print_audit();
    print_batch();
    print_system();
    print_system_info();
    return 0;
}
