/* Properties of include/tribo/material.h. */
#include <math.h>
#include <string.h>

#include "support/make.h"

/* What the check must say; where two ranges are broken, either may be named. */
static int expected(const tribo_material *m, tribo_status status)
{
    const int finite = isfinite(m->mu_s) && isfinite(m->mu_d) && isfinite(m->e);
    const int friction = m->mu_d >= 0.0 && m->mu_s >= m->mu_d;
    const int restitution = m->e >= 0.0 && m->e <= 1.0;
    return (status == TRIBO_OK && finite && friction && restitution) ||
           (status == TRIBO_ERROR_NOT_FINITE && !finite) ||
           (status == TRIBO_ERROR_FRICTION && !friction) ||
           (status == TRIBO_ERROR_RESTITUTION && !restitution);
}

static void make_wild(property_trial *t, const char *name, tribo_material *out)
{
    out->mu_s = make_any(t, NULL);
    out->mu_d = make_any(t, NULL);
    out->e = make_choice(t, NULL, 2) == 0 ? make_unit(t, NULL) : make_any(t, NULL);
    property_note(t, name, (const double *)out, 3);
}

/* A valid material of any size. */
static void make_extreme(property_trial *t, const char *name, tribo_material *out)
{
    make_material(t, NULL, out);
    if (make_choice(t, NULL, 2) == 1) {
        out->mu_s = fabs(make_finite(t, NULL));
        out->mu_d = out->mu_s * make_unit(t, NULL);
        out->e = fabs(make_finite(t, NULL));
        out->e = out->e > 1.0 ? 1.0 : out->e;
    }
    property_note(t, name, (const double *)out, 3);
}

static void check(property_trial *t)
{
    tribo_material m;
    make_wild(t, "material", &m);
    REQUIRE(t, expected(&m, tribo_material_check(&m)));
    REQUIRE_STATUS(t, tribo_material_check(NULL), TRIBO_ERROR_NULL);
}

static long double mix_reference(uint32_t rule, double left, double right)
{
    const long double a = (long double)left;
    const long double b = (long double)right;
    switch (rule) {
    case TRIBO_MIX_GEOMETRIC_MEAN:
        return sqrtl(a * b);
    case TRIBO_MIX_MINIMUM:
        return a < b ? a : b;
    case TRIBO_MIX_MAXIMUM:
        return a > b ? a : b;
    case TRIBO_MIX_PRODUCT:
        return a * b;
    default:
        return (a + b) / 2.0L;
    }
}

/* Each rule against its formula, to 2 eps (and the spacing of subnormal numbers). */
static void mix_formula(property_trial *t)
{
    tribo_material a;
    tribo_material b;
    tribo_material m;
    make_extreme(t, "a", &a);
    make_extreme(t, "b", &b);
    const uint32_t friction = make_choice(t, "friction rule", 5);
    const uint32_t restitution = make_choice(t, "restitution rule", 5);
    const long double mu_s = mix_reference(friction, a.mu_s, b.mu_s);
    const long double mu_d = mix_reference(friction, a.mu_d, b.mu_d);
    const long double e = mix_reference(restitution, a.e, b.e);
    canary_set(&m, sizeof m);
    const tribo_status status = tribo_material_mix(&a, &b, friction, restitution, &m);
    if (mu_s > (long double)DBL_MAX) {
        REQUIRE_STATUS(t, status, TRIBO_ERROR_RANGE);
        REQUIRE(t, canary_kept(&m, sizeof m));
        return;
    }
    const long double eps = (long double)EPS;
    REQUIRE_STATUS(t, status, TRIBO_OK);
    REQUIRE_NEAR(t, m.mu_s, mu_s, 2.0L * eps * mu_s + 0x1p-1074L);
    REQUIRE_NEAR(t, m.mu_d, mu_d, 2.0L * eps * mu_d + 0x1p-1074L);
    REQUIRE_NEAR(t, m.e, e, 2.0L * eps * e + 0x1p-1074L);
    REQUIRE_STATUS(t, tribo_material_check(&m), TRIBO_OK);
}

/* a with b is b with a, to the bit; a with itself is a, but for the product. */
static void mix_symmetric(property_trial *t)
{
    tribo_material a;
    tribo_material b;
    tribo_material left;
    tribo_material right;
    make_extreme(t, "a", &a);
    make_extreme(t, "b", &b);
    const uint32_t friction = make_choice(t, "friction rule", 5);
    const uint32_t restitution = make_choice(t, "restitution rule", 5);
    canary_set(&left, sizeof left);
    canary_set(&right, sizeof right);
    REQUIRE_STATUS(t, tribo_material_mix(&a, &b, friction, restitution, &left),
                   tribo_material_mix(&b, &a, friction, restitution, &right));
    REQUIRE_SAME(t, &left, &right, sizeof left);
    if (friction != TRIBO_MIX_PRODUCT && restitution != TRIBO_MIX_PRODUCT) {
        REQUIRE_STATUS(t, tribo_material_mix(&a, &a, friction, restitution, &left), TRIBO_OK);
        REQUIRE_NEAR(t, left.mu_s, a.mu_s, EPS * a.mu_s);
        REQUIRE_NEAR(t, left.mu_d, a.mu_d, EPS * a.mu_d);
        REQUIRE_NEAR(t, left.e, a.e, EPS * a.e);
    }
}

static void mix_bad(property_trial *t)
{
    tribo_material a;
    tribo_material b;
    tribo_material out;
    make_material(t, "a", &a);
    make_wild(t, "b", &b);
    const uint32_t rule = make_choice(t, "rule", 5);
    const uint32_t beyond = 5 + (uint32_t)make_bits(t, 4) % 0xfffffff0u;
    canary_set(&out, sizeof out);
    REQUIRE_STATUS(t, tribo_material_mix(NULL, &b, rule, rule, &out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_material_mix(&a, NULL, beyond, rule, &out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_material_mix(&a, &b, rule, rule, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_material_mix(&a, &b, beyond, rule, &out), TRIBO_ERROR_OPTION);
    REQUIRE_STATUS(t, tribo_material_mix(&a, &b, rule, beyond, &out), TRIBO_ERROR_OPTION);
    REQUIRE(t, canary_kept(&out, sizeof out));
    const tribo_status status = tribo_material_mix(&a, &b, rule, rule, &out);
    REQUIRE(t, status == TRIBO_ERROR_RANGE || expected(&b, status));
    REQUIRE(t, status == TRIBO_OK || canary_kept(&out, sizeof out));
    const tribo_status swapped = tribo_material_mix(&b, &a, rule, rule, &out);
    REQUIRE(t, swapped == status);
}

/* ---- a user's rule ------------------------------------------------------------------------ */

typedef struct call {
    const tribo_material *a;
    const tribo_material *b;
    tribo_material result;
    uint32_t count;
    uint32_t ordered;
} call;

static void recorded(const tribo_material *a, const tribo_material *b, void *user,
                     tribo_material *out)
{
    call *c = user;
    c->count++;
    c->ordered =
        a->mu_s == c->a->mu_s && b->mu_s == c->b->mu_s && a->e == c->a->e && b->e == c->b->e;
    *out = c->result;
}

static void mix_with(property_trial *t)
{
    tribo_material a;
    tribo_material b;
    tribo_material out;
    call c;
    make_material(t, "a", &a);
    make_material(t, "b", &b);
    memset(&c, 0, sizeof c);
    c.a = &a;
    c.b = &b;
    make_wild(t, "result", &c.result);
    if (make_choice(t, "valid", 2) == 1) {
        make_extreme(t, "result", &c.result);
    }
    canary_set(&out, sizeof out);
    const tribo_status status = tribo_material_mix_with(&a, &b, recorded, &c, &out);
    REQUIRE(t, c.count == 1 && c.ordered);
    REQUIRE(t, expected(&c.result, status));
    if (status == TRIBO_OK) {
        REQUIRE_SAME(t, &out, &c.result, sizeof out);
    } else {
        REQUIRE(t, canary_kept(&out, sizeof out));
    }
}

static void mix_with_bad(property_trial *t)
{
    tribo_material a;
    tribo_material b;
    tribo_material out;
    call c;
    make_material(t, "a", &a);
    make_wild(t, "b", &b);
    memset(&c, 0, sizeof c);
    c.a = &a;
    c.b = &b;
    c.result = a;
    canary_set(&out, sizeof out);
    REQUIRE_STATUS(t, tribo_material_mix_with(NULL, &b, recorded, &c, &out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_material_mix_with(&a, NULL, recorded, &c, &out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_material_mix_with(&a, &b, NULL, &c, &out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_material_mix_with(&a, &b, recorded, &c, NULL), TRIBO_ERROR_NULL);
    REQUIRE(t, c.count == 0 && canary_kept(&out, sizeof out));
    const tribo_status status = tribo_material_mix_with(&a, &b, recorded, &c, &out);
    REQUIRE(t, expected(&b, status));
    REQUIRE(t, status == TRIBO_OK || (c.count == 0 && canary_kept(&out, sizeof out)));
}

/* ---- the table ---------------------------------------------------------------------------- */

static void table(property_trial *t)
{
    const char *name = NULL;
    tribo_material at;
    tribo_material found;
    const uint32_t count = tribo_material_count();
    const uint32_t index = make_choice(t, "index", 4);
    canary_set(&at, sizeof at);
    const tribo_status status = tribo_material_at(index, &name, &at);
    REQUIRE(t, count >= 2);
    if (index >= count) {
        REQUIRE(t, status == TRIBO_ERROR_INDEX && name == NULL && canary_kept(&at, sizeof at));
        return;
    }
    REQUIRE_STATUS(t, status, TRIBO_OK);
    REQUIRE(t, name != NULL && name[0] != '\0');
    REQUIRE_STATUS(t, tribo_material_check(&at), TRIBO_OK);
    REQUIRE_STATUS(t, tribo_material_find(name, &found), TRIBO_OK);
    REQUIRE_SAME(t, &at, &found, sizeof at);
    REQUIRE_STATUS(t, tribo_material_at(index, NULL, &found), TRIBO_OK);
    REQUIRE_SAME(t, &at, &found, sizeof at);
}

static void table_bad(property_trial *t)
{
    char name[32] = "steel on steel";
    const char *kept = name;
    tribo_material out;
    const uint32_t count = tribo_material_count();
    const uint32_t beyond = count + (uint32_t)make_bits(t, 4) % (UINT32_MAX - count);
    canary_set(&out, sizeof out);
    REQUIRE_STATUS(t, tribo_material_at(beyond, &kept, &out), TRIBO_ERROR_INDEX);
    REQUIRE_STATUS(t, tribo_material_at(beyond, &kept, NULL), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_material_at(0, &kept, NULL), TRIBO_ERROR_NULL);
    REQUIRE(t, kept == name);
    REQUIRE_STATUS(t, tribo_material_find(NULL, &out), TRIBO_ERROR_NULL);
    REQUIRE_STATUS(t, tribo_material_find(name, NULL), TRIBO_ERROR_NULL);
    const uint8_t place = make_byte(t) % 15;
    const char letter = (char)make_byte(t);
    const char old = name[place];
    name[place] = letter;
    const tribo_status status = tribo_material_find(name, &out);
    REQUIRE(t, status == (letter == old ? TRIBO_OK : TRIBO_ERROR_NAME));
    REQUIRE(t, status == TRIBO_OK || canary_kept(&out, sizeof out));
}

const char *const property_room = "material";
const property property_list[] = {
    {"check", check, 1},     {"mix_formula", mix_formula, 1}, {"mix_symmetric", mix_symmetric, 1},
    {"mix_bad", mix_bad, 1}, {"mix_with", mix_with, 1},       {"mix_with_bad", mix_with_bad, 1},
    {"table", table, 1},     {"table_bad", table_bad, 1},
};
const size_t property_count = PROPERTY_COUNT(property_list);
const unsigned property_trials = 100000;
