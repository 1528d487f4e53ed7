/* Messages with the simulator over the serial line; one framing is compiled in, see build_settings.h. */
#ifndef LINK_H
#define LINK_H

#include <stdint.h>

void link_begin(void);

/* Take one byte; a message that it completes is answered at once. */
void link_receive(uint8_t byte);

#endif
