// The robot's controller on an Arduino Mega 2560, with sensors and motors played by the simulator over USB.
// Your part is in student.c. Serial, and with it the Serial Monitor, is taken by the link to the simulator.

extern "C" {
#include "board.h"
}

void setup()
{
    board_begin();
}

void loop()
{
    board_round();
}
