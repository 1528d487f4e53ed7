"""A file with an effect of one's own to begin with, for those slots in which there is more than one law."""

import inspect

from configs.effects.base import Slot
from configs.effects.registry import EFFECTS
from pipeline.code_files import new_class_name
from pipeline.effects.template_laws import LAWS
from symolo.core.errors import InputError, nearest

TEXT = '''"""{about}"""

from typing import Annotated

import numpy as np

from configs.effects.base import Effect, Setup, Slot
from configs.effects.parameter import Parameter
{imports}from symolo.core.arrays import Array

# The name of the class in lower case is the name of the effect: robot.effects.{name}
# `symolo effect check` tests the file and explains each rule.


class {class_name}(Effect):
    slot = Slot.{slot}  # where it acts: {words}
    cause = "{cause}"
    excitation = "{excitation}"
    # Measurements in which the diagnosis looks for it.
    setups = ({setups})

    # Unit, value without effect, visible value at which a fit starts, and bounds. The name ends in the unit.
    # A further number of shape, such as a decay length, has null=None.
    {number}
    """{meaning}"""

    def apply(self, {arguments}) -> Array:
        # A pure function: no random numbers, no memory, no change of the arguments. Everything may be an array, also
        # self.{parameter}, since a fit computes many robots at once. Take np.where in the place of if.
        return {result}
'''


def template(name: str, slot: Slot) -> str:
    """Return the text of a file with one effect that keeps the contract.

    Args:
        name: Name of the effect in lower case with underscores.
        slot: One of `LAWS`.

    Raises:
        InputError: The name cannot be that of an effect, or a shipped effect has it.
    """
    law = LAWS[slot]
    imports = "".join(f"{line}\n" for line in law.imports)
    text = TEXT.format(
        about=law.about,
        imports=imports,
        name=name,
        class_name=new_class_name(name, EFFECTS, "oval_wheel"),
        slot=slot.name,
        words=slot,
        cause=law.cause,
        excitation=law.excitation,
        setups=law.setups if "," in law.setups else f"{law.setups},",
        number=law.number,
        meaning=law.meaning,
        arguments=law.arguments,
        parameter=law.number.partition(":")[0],
        result=law.result,
    )
    text = text.replace("import numpy as np\n\n", "") if "np." not in law.result else text
    return text if "Array" in law.arguments else text.replace("from symolo.core.arrays import Array\n", "")


def slot_named(text: str) -> Slot:
    """Return the slot with a name, whose words may be joined by '-' or '_'.

    Raises:
        InputError: There is none, or no file can be written for it.
    """
    known = {slot.value: slot for slot in Slot}
    name = text.lower().replace("-", " ").replace("_", " ")
    allowed = ", ".join(sorted(LAWS))
    if name not in known:
        raise InputError("--slot", got=text, allowed=allowed, nearest=nearest(name, LAWS))
    slot = known[name]
    if slot not in LAWS:
        shipped = next((effect for effect in EFFECTS.shipped if effect.slot is slot), None)
        cure = f"there is no template for this slot; begin with a copy of {inspect.getfile(shipped)}" if shipped else ""
        raise InputError("--slot", got=text, allowed=allowed, cure=cure)
    return slot
