"""The Python face: teams, rollouts, studies, replays, probes. `import wonderful_team as wt` offers what stands here."""
