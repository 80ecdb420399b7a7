#include "throw.h"

#include <math.h>
#include <string.h>

/* Beyond this an impulse is outside of the cone, energy gained, restitution broken; without unit.
 */
static const double ROUNDING = 1e-12;

static const double DEGREES = 57.295779513082320877; /* in a radian */

typedef struct audit_run {
    throw_record *record;
    tribo_body floor;
    tribo_status status;
} audit_run;

tumble throw_scene(uint32_t law)
{
    const tumble scene = {{0.10, 0.06, 0.04},
                          9.81,
                          0.05,
                          {0.35, 0.30, 0.60},
                          {.struct_size = sizeof(tribo_impact_options), .law = law}};

    return scene;
}

tribo_status throw_start(tribo_body *box)
{
    static const double density = 700.0; /* of oak, kg/m^3 */
    const tumble scene = throw_scene(TRIBO_LAW_ALGEBRAIC);
    const double turn[3] = {0.4, 0.7, -0.3};
    double mass, inertia[9];

    tribo_status status = tribo_body_init(box);
    if (status == TRIBO_OK)
        status = tribo_mass_box(density, scene.half, &mass, inertia);
    if (status == TRIBO_OK)
        status = tribo_body_set_mass(box, mass, inertia);
    if (status == TRIBO_OK)
        status = tribo_quat_from_rotation_vector(turn, box->orientation);
    memcpy(box->position, (const double[3]){0.0, 0.0, 0.40}, sizeof box->position);
    memcpy(box->velocity, (const double[3]){2.2, 0.5, 0.3}, sizeof box->velocity);
    memcpy(box->angular_velocity, (const double[3]){3.0, 9.0, 4.0}, sizeof box->angular_velocity);
    return status;
}

/* The floor as a body so heavy that it hardly moves: it takes what the box gives. */
static tribo_status make_floor(tribo_body *floor)
{
    const double mass = 1e12;
    const double inertia[9] = {mass, 0.0, 0.0, 0.0, mass, 0.0, 0.0, 0.0, mass};

    const tribo_status status = tribo_body_init(floor);
    return status == TRIBO_OK ? tribo_body_set_mass(floor, mass, inertia) : status;
}

/* Change of the totals of box and floor about one common point, which is neither's centre of mass.
 */
static tribo_status audit_change(const audit_run *run, const tumble_impact *impact,
                                 tribo_change *out)
{
    static const double origin[3] = {0.5, 0.3, 0.1};
    tribo_body before[2] = {impact->before, run->floor}, after[2] = {impact->after, run->floor};
    tribo_totals totals[2];
    double arm[3], reaction[3];

    tribo_vec3_add(impact->before.position, impact->contact.arm_a, arm);
    tribo_vec3_scale(-1.0, impact->info.impulse_world, reaction);
    tribo_status status = tribo_body_apply_impulse(&after[1], arm, reaction);
    if (status == TRIBO_OK)
        status = tribo_audit_bodies(2, before, origin, &totals[0]);
    if (status == TRIBO_OK)
        status = tribo_audit_bodies(2, after, origin, &totals[1]);
    return status == TRIBO_OK ? tribo_audit_change(&totals[0], &totals[1], out) : status;
}

static double greater(double a, double b)
{
    return a > b ? a : b;
}

/* How far the impulse is outside of the cone of static friction, the widest that friction allows.
 */
static double escape_of(const double p[3], double mu_s)
{
    const double tangent[3] = {p[1], p[2], 0.0};

    return greater(0.0, tribo_vec3_norm(tangent) - mu_s * p[0]) / tribo_vec3_norm(p);
}

static void observe(void *user, const tumble_impact *impact)
{
    audit_run *run = user;
    throw_record *record = run->record;
    throw_audit audit = {.info = impact->info,
                         .escape = escape_of(impact->info.impulse, impact->pair.mu_s)};
    double energy = 0.0;

    tribo_status status = audit_change(run, impact, &audit.change);
    if (status == TRIBO_OK)
        status = tribo_audit_impact(impact->info.matrix, impact->info.velocity_before,
                                    &impact->pair, impact->info.impulse, &audit.measures);
    if (status != TRIBO_OK)
        run->status = status;
    if (record->impacts++ == 0)
        record->first = audit;
    energy = audit.change.energy > ROUNDING ? impact->info.energy : 0.0;
    record->gains += energy > 0.0;
    record->escapes += audit.escape > ROUNDING;
    record->rebounds += fabs(audit.measures.velocity) > ROUNDING;
    record->greatest_gain = greater(record->greatest_gain, energy);
    record->greatest_escape = greater(record->greatest_escape, audit.escape);
    record->greatest_linear = greater(record->greatest_linear, audit.change.linear);
    record->greatest_angular = greater(record->greatest_angular, audit.change.angular);
}

static tribo_status total_energy(const tribo_body *box, const tumble *scene, double *energy)
{
    static const double origin[3] = {0.0, 0.0, 0.0};
    tribo_totals totals;

    const tribo_status status = tribo_audit_bodies(1, box, origin, &totals);
    if (status == TRIBO_OK)
        *energy = totals.energy + totals.mass * scene->gravity * box->position[2];
    return status;
}

tribo_status throw_box(uint32_t law, throw_record *record)
{
    const tumble scene = throw_scene(law);
    audit_run run = {.record = record};
    tribo_body box;
    double start[4];

    memset(record, 0, sizeof *record);
    tribo_status status = make_floor(&run.floor);
    if (status == TRIBO_OK)
        status = throw_start(&box);
    if (status == TRIBO_OK)
        status = total_energy(&box, &scene, &record->energy_before);
    memcpy(start, box.orientation, sizeof start);
    for (uint32_t frame = 0; frame < THROW_FRAMES && status == TRIBO_OK; frame++) {
        record->path[frame] = box;
        if (record->impacts == 0)
            record->first_frame = frame;
        status = tumble_advance(&scene, 1.0 / THROW_FRAMES_PER_SECOND, 4, &box, observe, &run);
    }
    if (status == TRIBO_OK)
        status = total_energy(&box, &scene, &record->energy_after);
    record->turned = tribo_quat_angle(start, box.orientation) * DEGREES;
    return status == TRIBO_OK ? run.status : status;
}
