/* What the program does on the board: start, then one round after the other. */
#ifndef BOARD_H
#define BOARD_H

void board_begin(void);

/* One round; sleeps until an interrupt where nothing is to be done. */
void board_round(void);

#endif
