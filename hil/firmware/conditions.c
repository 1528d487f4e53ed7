#include "conditions.h"

#include "settings.h"

bool on_line(const struct view *view)
{
    return view->line_seen;
}

bool wall_found(const struct view *view, enum side side)
{
    return side_mm(view->seen, side) < WALL_FOUND_WITHIN_MM;
}

bool line_ended_by_wall(const struct view *view, enum side side)
{
    return !on_line(view) && wall_found(view, side);
}

bool wall_lost(const struct view *view, enum side side)
{
    return side_mm(view->seen, side) > WALL_LOST_BEYOND_MM;
}

bool wall_back(const struct view *view, enum side side)
{
    return !wall_lost(view, side);
}

bool wall_goes_on_opposite(const struct view *view, enum side side)
{
    return wall_lost(view, side) && wall_found(view, other(side));
}

bool obstacle_ahead(const struct view *view, enum side free_side)
{
    return view->seen->front_mm < AVOIDANCE_FRONT_BELOW_MM &&
           side_mm(view->seen, free_side) >= AVOIDANCE_FREE_SIDE_BEYOND_MM;
}

bool curve_beside(const struct view *view, enum side side)
{
    return view->curve_found && view->curve_side == side;
}

bool corner_ahead(const struct view *view)
{
    return view->seen->front_mm < CORNER_FRONT_BELOW_MM;
}

bool corner_turned(const struct view *view, enum side wall_side)
{
    return view->seen->front_mm > CORNER_FRONT_CLEAR_MM && wall_found(view, wall_side);
}

bool line_met_on_the_way_back(const struct view *view)
{
    return view->straight_path_goes_back && view->return_state == STATE_LINE && on_line(view);
}

bool avoided(const struct view *view, enum state into)
{
    return view->path_finished && view->return_state == into;
}
