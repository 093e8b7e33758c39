"""Ablation: runs variants of a method on one data set, and compares each with the original."""
