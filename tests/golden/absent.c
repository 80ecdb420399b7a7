/* Stands in for libccd and for hull.c, which needs Qhull, where they cannot be had: a portal search
 * that never finds a portal, and no hulls. */
#include "hull.h"

#include <ccd/ccd.h>

int ccdMPRPenetration(const void *obj1, const void *obj2, const ccd_t *ccd, ccd_real_t *depth,
                      ccd_vec3_t *dir, ccd_vec3_t *pos)
{
    (void)obj1;
    (void)obj2;
    (void)ccd;
    (void)depth;
    (void)dir;
    (void)pos;
    return -1;
}

void ccdFirstDirDefault(const void *obj1, const void *obj2, ccd_vec3_t *dir)
{
    (void)obj1;
    (void)obj2;
    ccdVec3Set(dir, 1.0, 0.0, 0.0);
}

int hull_head_is_valid(const void *block)
{
    (void)block;
    return 0;
}

uint32_t hull_support(const hull_block *hull, const double direction[3])
{
    (void)hull;
    (void)direction;
    return 0;
}

uint32_t hull_face_at(const hull_block *hull, uint32_t vertex, const double direction[3])
{
    (void)hull;
    (void)vertex;
    (void)direction;
    return 0;
}

void hull_moments(const hull_block *hull, double scale, double *volume, double center[3],
                  double second[6])
{
    (void)hull;
    (void)scale;
    (void)center;
    (void)second;
    *volume = 0.0;
}
