#include "path_store.h"

#include "paths.h"
#include "settings.h"

#define PATH(name, side)                                                                                               \
    {                                                                                                                  \
        FLASH_ADDRESS(name##_POINTS), sign_of(side), name##_SPACING_M, name##_COUNT, name##_BACK_BEGINS,               \
            name##_AHEAD_POINTS, name##_WINDOW_POINTS                                                                  \
    }

struct path straight_path(enum side side)
{
    struct path path = PATH(STRAIGHT, side);
    return path;
}

#if HAS_CURVES

struct path inner_path(enum side bend)
{
    struct path path = PATH(INNER, bend);
    return path;
}

struct path outer_path(enum side bend)
{
    struct path path = PATH(OUTER, bend);
    return path;
}

#endif
