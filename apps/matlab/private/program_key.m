function key = program_key(name)
%PROGRAM_KEY  The program's name of a key: xEnd.thickness_m is end.thickness_m.
key = regexprep(char(name), '^xEnd(\.|$)', 'end$1');
end
