"""How the page looks: on light and dark screens, and on paper."""

STYLE = """
:root { color-scheme: light dark; --ink: #1b1f24; --paper: #ffffff; --soft: #f3f5f7; --line: #d5dae0; --mark: #0072b2;
  --warn: #b34700; --faint: #57606a; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6e9ed; --paper: #14171a; --soft: #1f2429; --line: #3a424b;
  --mark: #6cbcf0; --warn: #f0a060; --faint: #9aa5b1; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 74rem; padding: 1.5rem 1.2rem 4rem; color: var(--ink); background: var(--paper);
  font: 16px/1.5 system-ui, sans-serif; }
h1 { font-size: 1.15rem; font-weight: 600; color: var(--faint); margin: 0 0 .3rem; }
h2 { font-size: 1.2rem; margin: 2.4rem 0 .6rem; padding-top: .6rem; border-top: 1px solid var(--line); }
h3 { font-size: 1.05rem; margin: 1.4rem 0 .3rem; }
p, ul, dl { max-width: 62rem; margin: .4rem 0; }
.verdict { font-size: 1.5rem; line-height: 1.3; font-weight: 600; margin: .2rem 0 .6rem; }
.glance { font-size: 1.05rem; }
.note { color: var(--faint); font-size: .92rem; }
.warn { color: var(--warn); }
.wide { overflow-x: auto; margin: .6rem 0; }
table { border-collapse: collapse; font-size: .92rem; font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: .25rem .7rem .25rem 0; border-bottom: 1px solid var(--line); vertical-align: top; }
th { font-weight: 600; color: var(--faint); }
td.n, .matrix td { text-align: right; padding: .2rem .6rem; }
.matrix td:first-child, .matrix td:nth-child(2) { text-align: left; padding-left: 0; }
tr.found td:first-child { font-weight: 700; color: var(--mark); }
figure { margin: .8rem 0 1.2rem; }
img { max-width: 100%; background: #ffffff; border-radius: 6px; padding: 4px; border: 1px solid var(--line); }
figcaption { color: var(--faint); font-size: .92rem; max-width: 62rem; }
code, pre { font: .9em ui-monospace, monospace; background: var(--soft); border-radius: 4px; }
code { padding: .05rem .3rem; }
pre { padding: .8rem; overflow-x: auto; }
details { margin: .6rem 0; }
summary { cursor: pointer; font-weight: 600; }
.card { background: var(--soft); border-radius: 8px; padding: .7rem 1rem; margin: .8rem 0; }
.card h3 { margin-top: 0; }
@media print { html { font-size: 11px; }
  body { max-width: none; font-size: 1rem; padding: 0; } h2 { break-after: avoid; }
  figure, .card, tr { break-inside: avoid; } .wide { overflow: visible; }
  table { font-size: .8rem; } th, td, .matrix td { padding-right: .35rem; } .matrix td { padding-left: .2rem; }
  pre { white-space: pre-wrap; } }
"""
