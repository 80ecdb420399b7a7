#include "recorded.h"

#include <stdlib.h>

static int grow(entries *matrix)
{
    const size_t room = matrix->room > 0 ? 2 * matrix->room : 64;
    uint32_t *places = realloc(matrix->places, 2 * room * sizeof *places);
    double *values = NULL;

    if (places != NULL) {
        matrix->places = places;
        values = realloc(matrix->values, room * sizeof *values);
    }
    if (values == NULL)
        return -1;
    matrix->values = values;
    matrix->room = room;
    return 0;
}

int entries_add(entries *matrix, uint32_t row, uint32_t column, double value)
{
    if (value == 0.0)
        return 0;
    if (matrix->count == matrix->room && grow(matrix) != 0)
        return -1;
    matrix->places[2 * matrix->count] = row;
    matrix->places[2 * matrix->count + 1] = column;
    matrix->values[matrix->count++] = value;
    return 0;
}

static void entries_free(entries *matrix)
{
    free(matrix->places);
    free(matrix->values);
}

void recorded_free(recorded *given)
{
    entries_free(&given->matrix);
    entries_free(&given->h);
    free(given->f);
    free(given->q);
    free(given->mu);
    *given = (recorded){0};
}
