/* What a block is to block.c: its variables are numbers in one array, which is also its whole memory. */
#ifndef BLOCK_H
#define BLOCK_H

/* Takes the block from `time` over one communication step; `v` is indexed by the names in variables.h. */
void advance(double *v, double time, double step);

#endif
