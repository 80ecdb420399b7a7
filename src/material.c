#include <tribo/material.h>

#include "bits.h"

#include <math.h>

typedef struct table_entry {
    const char *name;
    tribo_material material;
} table_entry;

static const table_entry table[] = {
    {"wood on stone", {0.7, 0.3, 0.0}},
    {"steel on steel", {0.16, 0.12, 0.0}},
};

enum { TABLE_COUNT = sizeof table / sizeof table[0] };

tribo_status tribo_material_check(const tribo_material *material)
{
    if (!material) {
        return TRIBO_ERROR_NULL;
    }
    const double values[3] = {material->mu_s, material->mu_d, material->e};
    if (!all_finite(values, 3)) {
        return TRIBO_ERROR_NOT_FINITE;
    }
    if (material->mu_d < 0.0 || material->mu_s < material->mu_d) {
        return TRIBO_ERROR_FRICTION;
    }
    return material->e >= 0.0 && material->e <= 1.0 ? TRIBO_OK : TRIBO_ERROR_RESTITUTION;
}

/* The means are formed at a scale where they neither over- nor underflow; equal values stay as they
 * are. */
static double mix(double a, double b, uint32_t rule)
{
    switch (rule) {
    case TRIBO_MIX_GEOMETRIC_MEAN: {
        const uint64_t ea = scale_exponent(a) | 1u; /* odd when biased: an even power of two */
        const uint64_t eb = scale_exponent(b) | 1u;
        const double root = sqrt((a * power_of_two(ea)) * (b * power_of_two(eb)));
        return root / power_of_two((ea + 1023u) / 2u) / power_of_two((eb + 1023u) / 2u);
    }
    case TRIBO_MIX_MINIMUM:
        return lesser(a, b);
    case TRIBO_MIX_MAXIMUM:
        return greater(a, b);
    case TRIBO_MIX_PRODUCT:
        return a * b;
    default: {
        const double s = power_of_two(scale_exponent(greater(a, b)));
        return 0.5 * (s * a + s * b) / s;
    }
    }
}

tribo_status tribo_material_mix(const tribo_material *a, const tribo_material *b,
                                uint32_t friction_rule, uint32_t restitution_rule,
                                tribo_material *out)
{
    if (!a || !b || !out) {
        return TRIBO_ERROR_NULL;
    }
    if (friction_rule > TRIBO_MIX_ARITHMETIC_MEAN || restitution_rule > TRIBO_MIX_ARITHMETIC_MEAN) {
        return TRIBO_ERROR_OPTION;
    }
    tribo_status status = tribo_material_check(a);
    if (status == TRIBO_OK) {
        status = tribo_material_check(b);
    }
    if (status != TRIBO_OK) {
        return status;
    }
    const tribo_material mixed = {
        mix(a->mu_s, b->mu_s, friction_rule),
        mix(a->mu_d, b->mu_d, friction_rule),
        mix(a->e, b->e, restitution_rule),
    };
    if (!(mixed.mu_s - mixed.mu_s == 0.0)) {
        return TRIBO_ERROR_RANGE;
    }
    *out = mixed;
    return TRIBO_OK;
}

tribo_status tribo_material_mix_with(const tribo_material *a, const tribo_material *b,
                                     tribo_mix_function rule, void *user, tribo_material *out)
{
    if (!a || !b || !rule || !out) {
        return TRIBO_ERROR_NULL;
    }
    tribo_status status = tribo_material_check(a);
    if (status == TRIBO_OK) {
        status = tribo_material_check(b);
    }
    if (status != TRIBO_OK) {
        return status;
    }
    /* NaN until the rule has set it: a forgotten field is found out. */
    const double unset = double_of(0x7ff8000000000000u);
    tribo_material mixed = {unset, unset, unset};
    rule(a, b, user, &mixed);
    status = tribo_material_check(&mixed);
    if (status == TRIBO_OK) {
        *out = mixed;
    }
    return status;
}

uint32_t tribo_material_count(void)
{
    return TABLE_COUNT;
}

tribo_status tribo_material_at(uint32_t index, const char **name, tribo_material *out)
{
    if (!out) {
        return TRIBO_ERROR_NULL;
    }
    if (index >= TABLE_COUNT) {
        return TRIBO_ERROR_INDEX;
    }
    if (name) {
        *name = table[index].name;
    }
    *out = table[index].material;
    return TRIBO_OK;
}

tribo_status tribo_material_find(const char *name, tribo_material *out)
{
    if (!name || !out) {
        return TRIBO_ERROR_NULL;
    }
    for (uint32_t i = 0; i < TABLE_COUNT; i++) {
        if (strcmp(name, table[i].name) == 0) {
            *out = table[i].material;
            return TRIBO_OK;
        }
    }
    return TRIBO_ERROR_NAME;
}
