/* What the tree of boxes does for the scene beside its public calls. */
#ifndef TRIBO_TREE_H
#define TRIBO_TREE_H

#include <tribo/broad.h>

/* tribo_tree_move with a margin of the body's own: moves of less cost nothing. Which pairs there are
 * does not depend on margins. */
tribo_status tree_move(tribo_tree *tree, uint32_t id, const double low[3], const double high[3],
                       double margin);

#endif
