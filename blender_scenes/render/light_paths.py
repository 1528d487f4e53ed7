"""Numbers that limit how far Cycles follows light; docs/rendering.md says what each preset leaves out."""

from dataclasses import dataclass, replace

from configs.schema.appearance.light_paths import LightPathPreset, LightPaths


@dataclass(frozen=True)
class LightPathLimits:
    """Where a path of light ends, and how much light it carries at most."""

    diffuse_bounces: int
    glossy_bounces: int
    transmission_bounces: int
    caustics: bool
    """Whether gloss and glass throw patches of light on matt surfaces."""
    clamp: float
    """Maximum light of a path behind its first surface, in multiples of the light that the exposure renders white; 0
    for no limit."""

    @property
    def max_bounces(self) -> int:
        return max(self.diffuse_bounces, self.glossy_bounces, self.transmission_bounces)


LIGHT_PATHS: dict[LightPathPreset, LightPathLimits] = {
    "standard": LightPathLimits(32, 32, 32, caustics=False, clamp=256.0),
    "complete": LightPathLimits(64, 64, 64, caustics=True, clamp=0.0),
}
"""`benchmarks/render/errors/light_left.py` measures how much light each leaves out. More bounces cost little, as Cycles
ends paths at random once they carry little light (Russian roulette)."""


def light_path_limits(config: LightPaths, automatic: LightPathPreset) -> LightPathLimits:
    """Return the limits of the preset, `automatic` for `auto`, with the numbers of `config` in place of its own."""
    preset = LIGHT_PATHS[automatic if config.preset == "auto" else config.preset]
    return replace(preset, **config.model_dump(exclude={"preset"}, exclude_none=True))
