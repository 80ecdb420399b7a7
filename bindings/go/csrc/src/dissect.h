/* Nested dissection of the graph of a symmetric matrix (George, SIAM J. Numer. Anal. 10 (1973) 345;
 * George & Liu, SIAM J. Numer. Anal. 15 (1978) 1053): it is halved again and again by a level of a
 * breadth-first search, of which those stay that have a neighbour beyond. Without a state of its
 * own, unlike METIS, which draws from rand() and catches signals of the whole process. */
#ifndef TRIBO_DISSECT_H
#define TRIBO_DISSECT_H

#include <stddef.h>

/* Number of ints that dissect works in. */
size_t dissect_room(int n, int entries);

/* sets[i]: when row i is to be eliminated; rows of one set in any order among them. The pattern is
 * the lower triangle, columns ascending, the diagonal last. `entries` of it are row_starts[n]. */
void dissect(int n, const int *row_starts, const int *columns, int *room, int *sets);

#endif
