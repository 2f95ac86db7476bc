"""How large, how near, how far may it grow? Moments, nearest points, safe scales, gaps."""
