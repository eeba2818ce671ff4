"""Runs side by side: what differs in their configuration, and in the flights that they have in
common.
"""
