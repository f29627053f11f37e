"""The five screens: Recipes, Run, Manual, Results, Bus."""
