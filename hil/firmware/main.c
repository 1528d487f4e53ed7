/* The program without the Arduino core; a sketch has its .ino file instead. */
#ifdef __AVR__

#include "board.h"

int main(void)
{
    board_begin();
    for (;;)
        board_round();
}

#endif
