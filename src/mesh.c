/* Triangle meshes as flat blocks: building without allocation, checking, the query by bounds. */
#include "mesh.h"

#define MAX_FACES ((size_t)1 << 30) /* so that sides count in 32 bits */
#define MAX_VERTICES ((size_t)1 << 31)
#define SLIVER 1e-12 /* of the square of the longest edge: the least of twice an area */
#define BEND 1e-6    /* sine of the angle between neighbours that still count as one plane */

/* ---- layout ---------------------------------------------------------------------------------- */

/* All leaves but the last are full, so that the number of nodes follows from that of the faces. */
static uint32_t leaves_of(uint32_t face_count)
{
    return (face_count + MESH_LEAF - 1u) / MESH_LEAF;
}

/* Nodes of a tree over so many leaves. */
static uint32_t nodes_of(uint32_t leaves)
{
    return 2u * leaves - 1u;
}

static void lay_out(mesh_block *head, uint32_t vertex_count, uint32_t face_count)
{
    const uint64_t faces = face_count;
    uint64_t end = sizeof *head;
    memset(head, 0, sizeof *head);
    head->magic = MESH_MAGIC;
    head->version = MESH_VERSION;
    head->vertex_count = vertex_count;
    head->face_count = face_count;
    head->node_count = nodes_of(leaves_of(face_count));
    /* Before there are nodes, their place serves for sorting: the sides of all faces, twice. */
    const uint64_t nodes = head->node_count * sizeof(mesh_node);
    const uint64_t sides = faces * 6u * sizeof(uint32_t);
    head->vertices = block_place(&end, (uint64_t)vertex_count * 3u * sizeof(double));
    head->faces = block_place(&end, faces * sizeof(mesh_face));
    head->nodes = block_place(&end, nodes > sides ? nodes : sides);
    head->order = block_place(&end, faces * sizeof(uint32_t));
    head->bytes = end;
}

static const mesh_node *mesh_nodes(const mesh_block *mesh)
{
    return (const mesh_node *)(const void *)((const unsigned char *)mesh + mesh->nodes);
}

static const uint32_t *mesh_order(const mesh_block *mesh)
{
    return (const uint32_t *)(const void *)((const unsigned char *)mesh + mesh->order);
}

static void *own_place(mesh_block *mesh, uint64_t offset)
{
    return (unsigned char *)mesh + offset;
}

/* ---- head and vertices ----------------------------------------------------------------------- */

int mesh_head_is_valid(const void *block)
{
    const mesh_block *head = block;
    if (head->magic != MESH_MAGIC || head->version != MESH_VERSION || head->face_count < 1 ||
        head->face_count > MAX_FACES || head->vertex_count < 3 ||
        head->vertex_count > MAX_VERTICES) {
        return 0;
    }
    mesh_block expected;
    lay_out(&expected, head->vertex_count, head->face_count);
    return memcmp(head, &expected, offsetof(mesh_block, sum)) == 0;
}

static int vertices_are_finite(size_t count, const double *vertices)
{
    for (size_t i = 0; i < count; i++) {
        if (!all_finite(vertices + 3 * i, 3)) {
            return 0;
        }
    }
    return 1;
}

/* ---- triangles ------------------------------------------------------------------------------- */

/* By a power of two, which before the difference may carry large coordinates out of range, and after
 * it comes too late for their difference. */
static void scaled_edge(double scale, const double *from, const double *to, double out[3])
{
    for (int i = 0; i < 3; i++) {
        out[i] = scale > 1.0 ? scale * (to[i] - from[i]) : scale * to[i] - scale * from[i];
    }
}

static double largest_component(const double a[3])
{
    return greater(absolute(a[0]), greater(absolute(a[1]), absolute(a[2])));
}

/* Unit normal; 0 if the triangle has no area. */
static int triangle_normal(const double *a, const double *b, const double *c, double normal[3])
{
    double ab[3];
    double ac[3];
    double bc[3];
    scaled_edge(0.5, a, b, ab);
    scaled_edge(0.5, a, c, ac);
    const double scale =
        0.5 * power_of_two(scale_exponent(greater(largest_component(ab), largest_component(ac))));
    scaled_edge(scale, a, b, ab);
    scaled_edge(scale, a, c, ac);
    scaled_edge(scale, b, c, bc);
    tribo_vec3_cross(ab, ac, normal);
    const double area = sqrt(tribo_vec3_dot(normal, normal));
    const double longest =
        greater(tribo_vec3_dot(ab, ab), greater(tribo_vec3_dot(ac, ac), tribo_vec3_dot(bc, bc)));
    if (!(area > SLIVER * longest)) {
        return 0;
    }
    tribo_vec3_scale(1.0 / area, normal, normal);
    return 1;
}

static int normal_of(const double *vertices, const uint32_t *corners, double normal[3])
{
    return triangle_normal(vertices + 3 * (size_t)corners[0], vertices + 3 * (size_t)corners[1],
                           vertices + 3 * (size_t)corners[2], normal);
}

static void face_bounds(const mesh_block *mesh, uint32_t slot, double low[3], double high[3])
{
    const mesh_face *face = &mesh_faces(mesh)[slot];
    const double *a = mesh_vertices(mesh) + 3 * (size_t)face->vertices[0];
    const double *b = mesh_vertices(mesh) + 3 * (size_t)face->vertices[1];
    const double *c = mesh_vertices(mesh) + 3 * (size_t)face->vertices[2];
    for (int i = 0; i < 3; i++) {
        low[i] = lesser(a[i], lesser(b[i], c[i]));
        high[i] = greater(a[i], greater(b[i], c[i]));
    }
}

void mesh_extent(const mesh_block *mesh, const double rows[9], double low[3], double high[3])
{
    const double *vertices = mesh_vertices(mesh);
    const mesh_face *faces = mesh_faces(mesh);
    for (int i = 0; i < 3; i++) {
        low[i] = HUGE_VAL;
        high[i] = -HUGE_VAL;
    }
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        for (int k = 0; k < 3; k++) {
            double p[3];
            tribo_mat3_apply(rows, vertices + 3 * (size_t)faces[f].vertices[k], p);
            for (int i = 0; i < 3; i++) {
                low[i] = lesser(low[i], p[i]);
                high[i] = greater(high[i], p[i]);
            }
        }
    }
}

/* ---- sorting --------------------------------------------------------------------------------- */

typedef int (*order_function)(const void *context, uint32_t a, uint32_t b);

/* Stable, by merging ever longer runs; scratch holds as many. */
static void sort_ids(uint32_t *ids, uint32_t *scratch, size_t count, order_function before,
                     const void *context)
{
    uint32_t *from = ids;
    uint32_t *to = scratch;
    for (size_t run = 1; run < count; run *= 2) {
        for (size_t start = 0; start < count; start += 2 * run) {
            const size_t middle = start + run < count ? start + run : count;
            const size_t end = start + 2 * run < count ? start + 2 * run : count;
            size_t i = start;
            size_t j = middle;
            for (size_t k = start; k < end; k++) {
                const int second = i >= middle || (j < end && before(context, from[j], from[i]));
                to[k] = second ? from[j++] : from[i++];
            }
        }
        uint32_t *const swap = from;
        from = to;
        to = swap;
    }
    if (from != ids) {
        memcpy(ids, from, count * sizeof *ids);
    }
}

/* ---- edges ----------------------------------------------------------------------------------- */

/* -1, 0, 1. By position, so that triangles which do not share their vertices are neighbours too. */
static int compare_points(const double *a, const double *b)
{
    for (int i = 0; i < 3; i++) {
        if (a[i] != b[i]) {
            return a[i] < b[i] ? -1 : 1;
        }
    }
    return 0;
}

/* A side is a directed edge: 3 slot + k. */
static void side_ends(const mesh_block *mesh, uint32_t side, const double **from, const double **to)
{
    const uint32_t *corners = mesh_faces(mesh)[side / 3u].vertices;
    *from = mesh_vertices(mesh) + 3 * (size_t)corners[side % 3u];
    *to = mesh_vertices(mesh) + 3 * (size_t)corners[(side + 1u) % 3u];
}

/* The ends of a side, the lesser first. */
static void sorted_ends(const mesh_block *mesh, uint32_t side, const double **low,
                        const double **high)
{
    const double *from;
    const double *to;
    side_ends(mesh, side, &from, &to);
    const int turned = compare_points(from, to) > 0;
    *low = turned ? to : from;
    *high = turned ? from : to;
}

static int compare_edges(const mesh_block *mesh, uint32_t a, uint32_t b)
{
    const double *low_a;
    const double *high_a;
    const double *low_b;
    const double *high_b;
    sorted_ends(mesh, a, &low_a, &high_a);
    sorted_ends(mesh, b, &low_b, &high_b);
    const int order = compare_points(low_a, low_b);
    return order != 0 ? order : compare_points(high_a, high_b);
}

static int side_is_before(const void *context, uint32_t a, uint32_t b)
{
    return compare_edges(context, a, b) < 0;
}

/* Whether two neighbours bend away from each other, by the sine of the angle between their normals
 * about the edge; a blade folded back on itself does. */
static int is_ridge(const mesh_block *mesh, uint32_t a, uint32_t b)
{
    const mesh_face *faces = mesh_faces(mesh);
    const double *from;
    const double *to;
    double na[3];
    double nb[3];
    double turn[3];
    double edge[3];
    side_ends(mesh, a, &from, &to);
    normal_of(mesh_vertices(mesh), faces[a / 3u].vertices, na);
    normal_of(mesh_vertices(mesh), faces[b / 3u].vertices, nb);
    scaled_edge(0.5, from, to, edge);
    tribo_vec3_scale(power_of_two(scale_exponent(largest_component(edge))), edge, edge);
    tribo_vec3_cross(na, nb, turn);
    const double sine = tribo_vec3_dot(turn, edge) / sqrt(tribo_vec3_dot(edge, edge));
    return sine > BEND || (sine >= -BEND && tribo_vec3_dot(na, nb) < 0.0);
}

/* Whether exactly these two sides meet, and run against each other as on one surface. */
static int are_neighbours(const mesh_block *mesh, uint32_t a, uint32_t b)
{
    const double *from_a;
    const double *to_a;
    const double *from_b;
    const double *to_b;
    side_ends(mesh, a, &from_a, &to_a);
    side_ends(mesh, b, &from_b, &to_b);
    return compare_points(from_a, to_b) == 0 && compare_points(to_a, from_b) == 0;
}

static void flag_edges(mesh_block *mesh)
{
    const size_t count = 3 * (size_t)mesh->face_count;
    uint32_t *sides = own_place(mesh, mesh->nodes);
    mesh_face *faces = own_place(mesh, mesh->faces);
    for (size_t i = 0; i < count; i++) {
        sides[i] = (uint32_t)i;
    }
    sort_ids(sides, sides + count, count, side_is_before, mesh);
    for (size_t i = 0, end = 0; i < count; i = end) {
        for (end = i + 1; end < count && compare_edges(mesh, sides[i], sides[end]) == 0;) {
            end++;
        }
        const int is_inner = end - i == 2 && are_neighbours(mesh, sides[i], sides[i + 1]) &&
                             !is_ridge(mesh, sides[i], sides[i + 1]);
        for (size_t k = i; k < end && !is_inner; k++) {
            faces[sides[k] / 3u].flags |= MESH_ACTIVE(sides[k] % 3u);
        }
    }
}

/* ---- the tree -------------------------------------------------------------------------------- */

/* Two zeros before each of the lower 21 bits. */
static uint64_t spread(uint64_t x)
{
    x = (x | x << 32) & 0x001f00000000ffffu;
    x = (x | x << 16) & 0x001f0000ff0000ffu;
    x = (x | x << 8) & 0x100f00f00f00f00fu;
    x = (x | x << 4) & 0x10c30c30c30c30c3u;
    return (x | x << 2) & 0x1249249249249249u;
}

static int code_is_before(const void *context, uint32_t a, uint32_t b)
{
    const uint64_t *codes = context;
    return codes[a] < codes[b];
}

/* Place of a face on the curve that visits the cells of an octree (Morton 1966). Halves first: the
 * sum and the difference of the largest numbers overflow. */
static uint64_t code_of(const mesh_block *mesh, const double low[3], double scale, uint32_t slot)
{
    double from[3];
    double to[3];
    uint64_t code = 0;
    face_bounds(mesh, slot, from, to);
    for (int i = 0; i < 3; i++) {
        const double middle = (0.5 * from[i] - 0.5 * low[i]) + (0.5 * to[i] - 0.5 * low[i]);
        const uint64_t cell = (uint64_t)(lesser(scale * middle, 2.0) * 1048575.0);
        code |= spread(cell & 0x1fffffu) << i;
    }
    return code;
}

/* What code_of needs: the lowest corner, and the scale that brings the faces into the octree. */
static double octree_of(const mesh_block *mesh, double low[3])
{
    static const double unturned[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    double high[3];
    double extent[3];
    mesh_extent(mesh, unturned, low, high);
    scaled_edge(0.5, low, high, extent);
    return 0.5 * power_of_two(scale_exponent(largest_component(extent)));
}

static void order_faces(mesh_block *mesh)
{
    uint64_t *codes = own_place(mesh, mesh->nodes);
    uint32_t *order = own_place(mesh, mesh->order);
    double low[3];
    const double scale = octree_of(mesh, low);
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        codes[f] = code_of(mesh, low, scale, f);
        order[f] = f;
    }
    sort_ids(order, (uint32_t *)(void *)(codes + mesh->face_count), mesh->face_count,
             code_is_before, codes);
}

static void grow(mesh_node *node, const double low[3], const double high[3], uint32_t least,
                 uint32_t greatest)
{
    for (int i = 0; i < 3; i++) {
        node->low[i] = lesser(node->low[i], low[i]);
        node->high[i] = greater(node->high[i], high[i]);
    }
    node->least = least < node->least ? least : node->least;
    node->greatest = greatest > node->greatest ? greatest : node->greatest;
}

static void fill_leaf(const mesh_block *mesh, uint32_t leaf, mesh_node *node)
{
    const uint32_t *order = mesh_order(mesh);
    const uint32_t rest = mesh->face_count - leaf * MESH_LEAF;
    node->first = leaf * MESH_LEAF;
    node->count = rest < MESH_LEAF ? rest : MESH_LEAF;
    for (uint32_t i = 0; i < node->count; i++) {
        const uint32_t slot = order[node->first + i];
        double low[3];
        double high[3];
        face_bounds(mesh, slot, low, high);
        grow(node, low, high, slot, slot);
    }
}

/* Node `at` over leaves [leaf, leaf + count), when its children are made. */
static mesh_node form_node(const mesh_block *mesh, uint32_t at, uint32_t leaf, uint32_t count)
{
    const mesh_node *left = &mesh_nodes(mesh)[at + 1];
    mesh_node node;
    memset(&node, 0, sizeof node);
    node.least = UINT32_MAX;
    node.skip = at + nodes_of(count);
    for (int i = 0; i < 3; i++) {
        node.low[i] = HUGE_VAL;
        node.high[i] = -HUGE_VAL;
    }
    if (count == 1) {
        fill_leaf(mesh, leaf, &node);
    } else {
        const mesh_node *right = left + nodes_of(count / 2u);
        grow(&node, left->low, left->high, left->least, left->greatest);
        grow(&node, right->low, right->high, right->least, right->greatest);
    }
    return node;
}

/* Leaves are halved each time: no deeper than 32. */
static void build_nodes(mesh_block *mesh, uint32_t at, uint32_t leaf, uint32_t count)
{
    if (count > 1) {
        const uint32_t half = count / 2u;
        build_nodes(mesh, at + 1, leaf, half);
        build_nodes(mesh, at + 1 + nodes_of(half), leaf + half, count - half);
    }
    mesh_node *nodes = own_place(mesh, mesh->nodes);
    nodes[at] = form_node(mesh, at, leaf, count);
}

/* ---- judging a block ------------------------------------------------------------------------- */

static int faces_are_valid(const mesh_block *mesh)
{
    const mesh_face *faces = mesh_faces(mesh);
    for (uint32_t i = 0; i < mesh->face_count; i++) {
        const uint32_t *v = faces[i].vertices;
        double normal[3];
        if (v[0] >= mesh->vertex_count || v[1] >= mesh->vertex_count ||
            v[2] >= mesh->vertex_count || !normal_of(mesh_vertices(mesh), v, normal) ||
            (i > 0 && faces[i].index <= faces[i - 1].index)) {
            return 0;
        }
    }
    return 1;
}

/* Whether the faces lie along the curve, those of one cell by rising slot. No slot then comes
 * twice. */
static int order_is_valid(const mesh_block *mesh)
{
    const uint32_t *order = mesh_order(mesh);
    double low[3];
    const double scale = octree_of(mesh, low);
    uint64_t before = 0;
    for (uint32_t i = 0; i < mesh->face_count; i++) {
        if (order[i] >= mesh->face_count) {
            return 0;
        }
        const uint64_t code = code_of(mesh, low, scale, order[i]);
        if (i > 0 && (code < before || (code == before && order[i] <= order[i - 1]))) {
            return 0;
        }
        before = code;
    }
    return 1;
}

/* Whether node `at` and all below it are what build_nodes makes. */
static int tree_is_valid(const mesh_block *mesh, uint32_t at, uint32_t leaf, uint32_t count)
{
    const uint32_t half = count / 2u;
    const mesh_node node = form_node(mesh, at, leaf, count);
    return memcmp(&node, &mesh_nodes(mesh)[at], sizeof node) == 0 &&
           (count == 1 ||
            (tree_is_valid(mesh, at + 1, leaf, half) &&
             tree_is_valid(mesh, at + 1 + nodes_of(half), leaf + half, count - half)));
}

uint64_t mesh_sum(const mesh_block *mesh)
{
    return block_sum(mesh, mesh->bytes, offsetof(mesh_block, sum));
}

/* The sum tells damage; the rest, a block that was written to deceive. */
tribo_status tribo_mesh_check(const void *block, size_t size)
{
    if (!block) {
        return TRIBO_ERROR_NULL;
    }
    const mesh_block *mesh = block;
    const int is_whole = block_is_aligned(block) && size >= sizeof *mesh &&
                         mesh_head_is_valid(block) && mesh->bytes <= size;
    return is_whole && mesh_sum(mesh) == mesh->sum &&
                   vertices_are_finite(mesh->vertex_count, mesh_vertices(mesh)) &&
                   faces_are_valid(mesh) && order_is_valid(mesh) &&
                   tree_is_valid(mesh, 0, 0, leaves_of(mesh->face_count))
               ? TRIBO_OK
               : TRIBO_ERROR_DATA;
}

/* ---- building -------------------------------------------------------------------------------- */

static tribo_status check_input(size_t vertex_count, const double *vertices, size_t count,
                                const uint32_t *triangles)
{
    if (vertex_count < 3 || vertex_count > MAX_VERTICES || count < 1 || count > MAX_FACES) {
        return TRIBO_ERROR_RANGE;
    }
    for (size_t i = 0; i < 3 * count; i++) {
        if (triangles[i] >= vertex_count) {
            return TRIBO_ERROR_INDEX;
        }
    }
    return vertices_are_finite(vertex_count, vertices) ? TRIBO_OK : TRIBO_ERROR_NOT_FINITE;
}

static uint32_t count_faces(const double *vertices, size_t count, const uint32_t *triangles)
{
    uint32_t faces = 0;
    for (size_t i = 0; i < count; i++) {
        double normal[3];
        faces += normal_of(vertices, triangles + 3 * i, normal) ? 1u : 0u;
    }
    return faces;
}

static void copy_faces(mesh_block *mesh, size_t count, const uint32_t *triangles)
{
    mesh_face *faces = own_place(mesh, mesh->faces);
    uint32_t slot = 0;
    for (size_t i = 0; i < count; i++) {
        double normal[3];
        if (normal_of(mesh_vertices(mesh), triangles + 3 * i, normal)) {
            memset(&faces[slot], 0, sizeof faces[slot]);
            memcpy(faces[slot].vertices, triangles + 3 * i, 3 * sizeof *triangles);
            faces[slot].index = (uint32_t)i;
            slot++;
        }
    }
}

tribo_status tribo_mesh_build(size_t vertex_count, const double *vertices, size_t count,
                              const uint32_t *triangles, void *block, size_t capacity,
                              size_t *needed)
{
    if (!vertices || !triangles || (!block && capacity != 0)) {
        return TRIBO_ERROR_NULL;
    }
    const tribo_status status = check_input(vertex_count, vertices, count, triangles);
    if (status != TRIBO_OK) {
        return status;
    }
    const uint32_t faces = count_faces(vertices, count, triangles);
    if (faces == 0) {
        return TRIBO_ERROR_DEGENERATE;
    }
    mesh_block head;
    lay_out(&head, (uint32_t)vertex_count, faces);
    if (needed) {
        *needed = (size_t)head.bytes;
    }
    if (capacity < head.bytes) {
        return TRIBO_ERROR_CAPACITY;
    }
    mesh_block *mesh = block;
    memset(block, 0, (size_t)head.bytes);
    *mesh = head;
    memcpy(own_place(mesh, head.vertices), vertices, 3 * vertex_count * sizeof *vertices);
    copy_faces(mesh, count, triangles);
    flag_edges(mesh);
    order_faces(mesh);
    memset(own_place(mesh, head.nodes), 0, (size_t)(head.order - head.nodes));
    build_nodes(mesh, 0, 0, leaves_of(faces));
    mesh->sum = mesh_sum(mesh);
    return TRIBO_OK;
}

/* ---- query ----------------------------------------------------------------------------------- */

static int boxes_touch(const double *low_a, const double *high_a, const double *low_b,
                       const double *high_b)
{
    return low_a[0] <= high_b[0] && low_b[0] <= high_a[0] && low_a[1] <= high_b[1] &&
           low_b[1] <= high_a[1] && low_a[2] <= high_b[2] && low_b[2] <= high_a[2];
}

void mesh_begin(const mesh_block *mesh, const double low[3], const double high[3],
                mesh_cursor *cursor)
{
    memset(cursor, 0, sizeof *cursor);
    cursor->mesh = mesh;
    memcpy(cursor->low, low, sizeof cursor->low);
    memcpy(cursor->high, high, sizeof cursor->high);
}

/* Keeps the batch sorted; when it is full its greatest slot gives way. */
static void take_slot(mesh_cursor *cursor, uint32_t slot)
{
    double low[3];
    double high[3];
    uint32_t at = cursor->count;
    face_bounds(cursor->mesh, slot, low, high);
    if (slot < cursor->next || !boxes_touch(low, high, cursor->low, cursor->high)) {
        return;
    }
    if (at == MESH_BATCH) {
        at--;
        if (slot > cursor->slots[at]) {
            return;
        }
    } else {
        cursor->count++;
    }
    for (; at > 0 && cursor->slots[at - 1] > slot; at--) {
        cursor->slots[at] = cursor->slots[at - 1];
    }
    cursor->slots[at] = slot;
}

static int is_of_interest(const mesh_cursor *cursor, const mesh_node *node)
{
    const int full = cursor->count == MESH_BATCH;
    return node->greatest >= cursor->next &&
           !(full && node->least > cursor->slots[MESH_BATCH - 1]) &&
           boxes_touch(node->low, node->high, cursor->low, cursor->high);
}

static void fill_batch(mesh_cursor *cursor)
{
    const mesh_block *mesh = cursor->mesh;
    const mesh_node *nodes = mesh_nodes(mesh);
    cursor->count = 0;
    cursor->taken = 0;
    for (uint32_t n = 0; n < mesh->node_count;) {
        const mesh_node *node = &nodes[n];
        const int enter = is_of_interest(cursor, node);
        for (uint32_t i = 0; i < node->count && enter; i++) {
            take_slot(cursor, mesh_order(mesh)[node->first + i]);
        }
        n = enter ? n + 1 : node->skip;
    }
    const int full = cursor->count == MESH_BATCH;
    cursor->next = full ? cursor->slots[MESH_BATCH - 1] + 1 : mesh->face_count;
}

int mesh_next(mesh_cursor *cursor, mesh_triangle *out)
{
    if (cursor->taken == cursor->count) {
        if (cursor->next >= cursor->mesh->face_count) {
            return 0;
        }
        fill_batch(cursor);
        if (cursor->count == 0) {
            return 0;
        }
    }
    const mesh_face *face = &mesh_faces(cursor->mesh)[cursor->slots[cursor->taken++]];
    const double *vertices = mesh_vertices(cursor->mesh);
    for (size_t k = 0; k < 3; k++) {
        memcpy(out->vertices + 3 * k, vertices + 3 * (size_t)face->vertices[k],
               3 * sizeof *vertices);
    }
    normal_of(vertices, face->vertices, out->normal);
    out->index = face->index;
    out->flags = face->flags;
    return 1;
}
