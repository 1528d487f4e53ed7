"""Stages: functions from folder to folder, each of which can run alone and again."""
