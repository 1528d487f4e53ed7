"""What this page has more than that of a diagnosis: contact sheets, strips, and room for wide tables."""

STYLE = """
h1 { font-size: 1.7rem; color: var(--ink); line-height: 1.2; }
nav { margin: .8rem 0; font-size: .95rem; }
nav a { margin-right: 1rem; white-space: nowrap; }
a { color: var(--mark); }
.verdict { font-size: 1.15rem; font-weight: 500; }
.wide img, figure > img { width: 100%; height: auto; }
.sheet { display: grid; grid-template-columns: repeat(6, 1fr); gap: .5rem; margin: .5rem 0 1rem; }
.sheet figure { margin: 0; }
.sheet img { width: 100%; height: auto; padding: 0; border-radius: 3px; display: block; }
.sheet figcaption { font-size: .78rem; line-height: 1.25; margin-top: .2rem; overflow-wrap: anywhere; }
@media (max-width: 50rem) { .sheet { grid-template-columns: repeat(3, 1fr); } }
.strip .axis { fill: var(--line); } .strip .band { fill: var(--line); } .strip .mark { fill: var(--mark); }
.draws th:nth-child(n+3):nth-child(-n+5), .runs th:nth-child(n+2):nth-child(-n+7) { text-align: right;
  padding: .2rem .6rem; }
.draws { font-size: .82rem; } .draws td { padding-top: .12rem; padding-bottom: .12rem; } .draws svg { display: block; }
td.field { white-space: nowrap; font-family: ui-monospace, monospace; font-size: .95em; }
td.hash { overflow-wrap: anywhere; font-family: ui-monospace, monospace; }
@media print { h1 { font-size: 1.5rem; } nav { display: none; } h3 { break-after: avoid; }
  .whole, .sheet, .note { break-inside: avoid; } .sheet { grid-template-columns: repeat(6, 1fr); gap: .3rem; }
  .sheet figcaption { font-size: .7rem; }
  .strip .band { fill: #bbbbbb; } .strip .mark { fill: #000000; } }
"""
